// SPDX-License-Identifier: Apache-2.0
// PNG by libpng. Its errors arrive by longjmp, which must not cross a C++ destructor: see `survives`.
#include "image/png.hpp"

#include <fmt/format.h>
#include <png.h>

#include <array>
#include <bit>
#include <csetjmp>
#include <cstdio>
#include <cstring>
#include <new>

#include "base/assert.hpp"
#include "image/check.hpp"
#include "relumine/error.hpp"

namespace relumine {
namespace {

/// What libpng's callbacks share with us.
struct PngIo {
    std::span<const std::uint8_t> in;  // still to be read
    std::vector<std::uint8_t> out;     // written so far
    std::array<char, 160> error{};     // filled before the jump; no allocation there
};

void on_error(png_structp png, png_const_charp message) {
    auto& error = static_cast<PngIo*>(png_get_error_ptr(png))->error;
    std::snprintf(error.data(), error.size(), "%s", message);
    png_longjmp(png, 1);
}

void on_warning(png_structp, png_const_charp) {}  // libpng would print it

void read_bytes(png_structp png, png_bytep data, std::size_t count) {
    auto& in = static_cast<PngIo*>(png_get_io_ptr(png))->in;
    if (count > in.size()) png_error(png, "an early end");
    std::memcpy(data, in.data(), count);
    in = in.subspan(count);
}

bool append(std::vector<std::uint8_t>& out, const std::uint8_t* data, std::size_t count) {
    try {
        out.insert(out.end(), data, data + count);
        return true;
    } catch (const std::bad_alloc&) {
        return false;
    }
}

void write_bytes(png_structp png, png_bytep data, std::size_t count) {
    if (!append(static_cast<PngIo*>(png_get_io_ptr(png))->out, data, count)) png_error(png, "out of memory");
}

void flush_bytes(png_structp) {}

/// Calls into libpng; false after an error. `calls` must not own anything: the jump skips its destructors.
template <typename Calls>
bool survives(png_structp png, const Calls& calls) {
    if (setjmp(png_jmpbuf(png)) != 0) return false;
    calls();
    return true;
}

/// libpng's pair of structures for reading one file.
class PngReader {
  public:
    PngReader(std::span<const std::uint8_t> encoded, const std::string& name) : name_(name) {
        io_.in = encoded;
        png_ = png_create_read_struct(PNG_LIBPNG_VER_STRING, &io_, on_error, on_warning);
        info_ = png_ ? png_create_info_struct(png_) : nullptr;
        if (info_) return;
        png_destroy_read_struct(&png_, nullptr, nullptr);
        fail_image(name_, "libpng that starts", "an error");
    }
    ~PngReader() { png_destroy_read_struct(&png_, &info_, nullptr); }
    PngReader(const PngReader&) = delete;
    PngReader& operator=(const PngReader&) = delete;

    /// Throws ImageError where libpng gives up.
    template <typename Calls>
    void run(const Calls& calls) {
        if (!survives(png_, [&] { calls(png_, info_); }))
            fail_image(name_, "an undamaged PNG file", io_.error.data());
    }
    [[nodiscard]] PngIo& io() { return io_; }

  private:
    std::string name_;
    PngIo io_;
    png_structp png_ = nullptr;
    png_infop info_ = nullptr;
};

struct PngHeader {
    png_uint_32 width = 0, height = 0;  // pixels
    int bit_depth = 0, color_type = 0, channels = 0;
};

void read_header(png_structp png, png_infop info, PngIo* io, PngHeader* header) {
    png_set_read_fn(png, io, read_bytes);
    png_set_user_limits(png, 0x7fffffff, 0x7fffffff);  // check_image_size words the error better
    png_read_info(png, info);
    png_get_IHDR(png, info, &header->width, &header->height, &header->bit_depth, &header->color_type, nullptr,
                 nullptr, nullptr);
    header->channels = png_get_channels(png, info);
}

/// Asks libpng to turn whatever the file holds into RGBA of 8 or 16 bits.
void request_rgba(png_structp png, png_infop info, int color_type) {
    png_set_expand(png);
    if ((color_type & PNG_COLOR_MASK_COLOR) == 0) png_set_gray_to_rgb(png);
    if ((color_type & PNG_COLOR_MASK_ALPHA) == 0 && png_get_valid(png, info, PNG_INFO_tRNS) == 0)
        png_set_add_alpha(png, 0xffff, PNG_FILLER_AFTER);
    if constexpr (std::endian::native == std::endian::little) png_set_swap(png);
    png_set_interlace_handling(png);
    png_read_update_info(png, info);
}

ByteImage empty_image(const PngHeader& header) {
    ByteImage image;
    image.width = static_cast<int>(header.width);
    image.height = static_cast<int>(header.height);
    const std::size_t values = std::size_t{4} * header.width * header.height;
    if (header.bit_depth == 16)
        image.rgba16.resize(values);
    else
        image.rgba8.resize(values);
    return image;
}

std::vector<png_bytep> row_pointers(ByteImage& image) {
    const std::size_t row = std::size_t{4} * static_cast<std::size_t>(image.width);
    std::vector<png_bytep> rows(static_cast<std::size_t>(image.height));
    for (std::size_t y = 0; y < rows.size(); ++y)
        rows[y] = image.rgba8.empty() ? reinterpret_cast<png_bytep>(image.rgba16.data() + y * row)
                                      : image.rgba8.data() + y * row;
    return rows;
}

/// libpng's pair of structures for writing one file.
class PngWriter {
  public:
    PngWriter() : png_(png_create_write_struct(PNG_LIBPNG_VER_STRING, &io_, on_error, on_warning)) {
        info_ = png_ ? png_create_info_struct(png_) : nullptr;
        if (info_) return;
        png_destroy_write_struct(&png_, nullptr);
        throw OutputError{"PNG: libpng does not start"};
    }
    ~PngWriter() { png_destroy_write_struct(&png_, &info_); }
    PngWriter(const PngWriter&) = delete;
    PngWriter& operator=(const PngWriter&) = delete;

    std::vector<std::uint8_t> write(png_uint_32 width, png_uint_32 height,
                                    std::span<const std::uint8_t> rgb) {
        const auto calls = [&] {
            png_set_write_fn(png_, &io_, write_bytes, flush_bytes);
            png_set_user_limits(png_, 0x7fffffff, 0x7fffffff);
            png_set_IHDR(png_, info_, width, height, 8, PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE,
                         PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
            png_set_sRGB(png_, info_, PNG_sRGB_INTENT_PERCEPTUAL);
            png_write_info(png_, info_);
            for (std::size_t y = 0; y < height; ++y) png_write_row(png_, rgb.data() + y * 3 * width);
            png_write_end(png_, info_);
        };
        if (!survives(png_, calls)) throw OutputError{fmt::format("PNG: {}", io_.error.data())};
        return std::move(io_.out);
    }

  private:
    PngIo io_;
    png_structp png_ = nullptr;
    png_infop info_ = nullptr;
};

}  // namespace

bool is_png(std::span<const std::uint8_t> bytes) { return starts_with(bytes, "\x89PNG\r\n\x1a\n"); }

ByteImage decode_png(std::span<const std::uint8_t> encoded, const std::string& name) {
    PngReader reader(encoded, name);
    PngHeader header;
    reader.run([&](png_structp png, png_infop info) { read_header(png, info, &reader.io(), &header); });
    check_image_size(header.width, header.height, name);
    const std::uint64_t bits_per_pixel =
        static_cast<std::uint64_t>(header.bit_depth) * static_cast<std::uint64_t>(header.channels);
    check_packed_size(bits_per_pixel * header.width * header.height / 8, encoded.size(), name);

    ByteImage image = empty_image(header);
    std::vector<png_bytep> rows = row_pointers(image);
    const std::size_t row_bytes = std::size_t{4} * header.width * (header.bit_depth == 16 ? 2 : 1);
    reader.run([&](png_structp png, png_infop info) {
        request_rgba(png, info, header.color_type);
        RELUMINE_ASSERT(png_get_rowbytes(png, info) == row_bytes);
        png_read_image(png, rows.data());
        png_read_end(png, nullptr);
    });
    return image;
}

std::vector<std::uint8_t> encode_png(int width, int height, std::span<const std::uint8_t> rgb) {
    const auto w = static_cast<png_uint_32>(width), h = static_cast<png_uint_32>(height);
    RELUMINE_ASSERT(width > 0 && height > 0 && rgb.size() == std::size_t{3} * w * h);
    return PngWriter().write(w, h, rgb);
}

}  // namespace relumine
