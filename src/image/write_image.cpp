// SPDX-License-Identifier: Apache-2.0
// write_image: which encoder a file name wants, by its extension.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <string_view>

#include "base/file.hpp"
#include "base/message.hpp"
#include "image/byte_image.hpp"
#include "image/exr.hpp"
#include "image/pfm.hpp"
#include "image/quantize.hpp"
#include "relumine/error.hpp"
#include "relumine/image.hpp"

namespace relumine {
namespace {

using Bytes = std::vector<std::uint8_t>;

std::string lower_extension(const std::string& path) {
    std::string extension = std::filesystem::path(path).extension().string();
    std::ranges::transform(extension, extension.begin(), [](char c) {
        return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    });
    return extension;
}

[[noreturn]] void refuse(const std::string& path, std::string_view expected, std::string_view found) {
    throw SettingsError{expected_found(path, expected, found)};
}

void check_layer(const Image& image, const Layer& layer, const std::string& path) {
    const auto pixels = static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
    if (!layer.channels.empty() && layer.pixels.size() == pixels * layer.channels.size()) return;
    refuse(path, fmt::format("{} x {} pixels in layer \"{}\"", image.width, image.height, layer.name),
           fmt::format("{} values of {} channels", layer.pixels.size(), layer.channels.size()));
}

/// An image made by hand may leave its window and frame empty: then they are the whole.
Image with_window(const Image& image) {
    Image whole = image;
    if (whole.window == PixelRect{}) whole.window = {0, 0, image.width, image.height};
    if (whole.frame_width == 0) whole.frame_width = whole.window.x1;
    if (whole.frame_height == 0) whole.frame_height = whole.window.y1;
    return whole;
}

void check_image(const Image& image, const std::string& path) {
    if (image.width < 1 || image.height < 1 || image.layers.empty())
        refuse(path, "a picture with pixels",
               fmt::format("{} x {} pixels in {} layers", image.width, image.height, image.layers.size()));
    if (image.window.width() != image.width || image.window.height() != image.height)
        refuse(path, fmt::format("a window of {} x {} pixels", image.width, image.height),
               fmt::format("{} x {}", image.window.width(), image.window.height()));
    for (const Layer& layer : image.layers) check_layer(image, layer, path);
}

void check_picture(const Image& image, const std::string& path) {
    if (!image.layer()) refuse(path, "a layer \"\", the picture itself", "only other layers");
}

Bytes exr_bytes(const Image& image, const std::string&, const WriteOptions& options) {
    return encode_exr(image, options.half_floats);
}

Bytes png_bytes(const Image& image, const std::string& path, const WriteOptions& options) {
    check_picture(image, path);
    if (!std::isfinite(options.exposure))
        refuse(path, "a finite exposure in stops", fmt::format("{}", options.exposure));
    return encode_png(image.width, image.height, quantize(image, options.exposure));
}

Bytes pfm_bytes(const Image& image, const std::string& path, const WriteOptions&) {
    check_picture(image, path);
    return encode_pfm(image);
}

}  // namespace

void write_image(const Image& image, const std::string& path, const WriteOptions& options) {
    struct Format {
        std::string_view extension;
        Bytes (*encode)(const Image&, const std::string&, const WriteOptions&);
    };
    constexpr std::array formats = {Format{".exr", exr_bytes}, Format{".png", png_bytes},
                                    Format{".pfm", pfm_bytes}};
    const std::string extension = lower_extension(path);
    const auto format = std::ranges::find(formats, extension, &Format::extension);
    if (format == formats.end())
        refuse(path, "a name that ends in .exr, .png or .pfm",
               extension.empty() ? "no extension" : fmt::format("\"{}\"", extension));
    const Image whole = with_window(image);
    check_image(whole, path);
    write_file_atomically(path, format->encode(whole, path, options));
}

}  // namespace relumine
