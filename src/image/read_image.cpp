// SPDX-License-Identifier: Apache-2.0
// read_image: which decoder a file wants, by its first bytes.
#include <array>

#include "base/file.hpp"
#include "image/byte_image.hpp"
#include "image/check.hpp"
#include "image/exr.hpp"
#include "image/hdr.hpp"
#include "image/jpeg.hpp"
#include "image/pfm.hpp"
#include "image/picture.hpp"
#include "image/png.hpp"
#include "image/srgb.hpp"
#include "relumine/error.hpp"
#include "relumine/image.hpp"

namespace relumine {
namespace {

std::vector<std::uint8_t> read_bytes(const std::string& path) {
    try {
        return read_file(path);
    } catch (const FileError& error) {
        throw ImageError{error.what()};
    }
}

/// The linear value of every integer sample from 0 to `levels` − 1.
std::vector<float> linear_table(std::size_t levels) {
    std::vector<float> table(levels);
    for (std::size_t i = 0; i < levels; ++i)
        table[i] =
            static_cast<float>(linear_from_srgb(static_cast<double>(i) / static_cast<double>(levels - 1)));
    return table;
}

/// R, G, B linear, and A where a pixel is not opaque.
template <typename Sample>
Image linear_picture(int width, int height, const std::vector<Sample>& rgba) {
    constexpr std::size_t levels = std::size_t{1} << (8 * sizeof(Sample));
    const std::vector<float> linear = linear_table(levels);
    const std::size_t count = rgba.size() / 4;
    bool opaque = true;
    for (std::size_t i = 0; i < count; ++i) opaque &= rgba[4 * i + 3] == levels - 1;
    std::vector<float> pixels;
    pixels.reserve(count * (opaque ? 3 : 4));
    for (std::size_t i = 0; i < count; ++i) {
        for (std::size_t c = 0; c < 3; ++c) pixels.push_back(linear[rgba[4 * i + c]]);
        if (!opaque) pixels.push_back(static_cast<float>(rgba[4 * i + 3]) / static_cast<float>(levels - 1));
    }
    const std::vector<std::string> names{"R", "G", "B", "A"};
    return make_picture(width, height, {names.begin(), names.begin() + (opaque ? 3 : 4)}, std::move(pixels));
}

Image decode_encoded_picture(std::span<const std::uint8_t> encoded, const std::string& path) {
    const ByteImage bytes = decode_byte_image(encoded, path);
    return bytes.rgba16.empty() ? linear_picture(bytes.width, bytes.height, bytes.rgba8)
                                : linear_picture(bytes.width, bytes.height, bytes.rgba16);
}

}  // namespace

Image read_image(const std::string& path) {
    struct Format {
        bool (*matches)(std::span<const std::uint8_t>);
        Image (*decode)(std::span<const std::uint8_t>, const std::string&);
    };
    constexpr std::array formats = {Format{is_exr, decode_exr}, Format{is_pfm, decode_pfm},
                                    Format{is_hdr, decode_hdr}, Format{is_png, decode_encoded_picture},
                                    Format{is_jpeg, decode_encoded_picture}};
    const std::vector<std::uint8_t> bytes = read_bytes(path);
    for (const Format& format : formats)
        if (format.matches(bytes)) return format.decode(bytes, path);
    fail_image(path, "an EXR, PFM, HDR, PNG or JPEG picture",
               bytes.empty() ? "an empty file" : "other content");
}

}  // namespace relumine
