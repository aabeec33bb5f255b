// SPDX-License-Identifier: Apache-2.0
// JPEG by libjpeg. Its errors arrive by longjmp, which must not cross a C++ destructor: see JpegReader::run.
#include "image/jpeg.hpp"

#include <jpeglib.h>

#include <csetjmp>
#include <cstddef>
#include <cstdio>
// jpeglib.h first: it declares what this one uses
#include <jerror.h>

#include "image/check.hpp"

namespace relumine {
namespace {

/// libjpeg's error manager, with the place to jump to behind it.
struct JpegErrors {
    jpeg_error_mgr manager{};  // first: libjpeg hands us a pointer to it
    std::jmp_buf jump{};
    char message[JMSG_LENGTH_MAX]{};
};

[[noreturn]] void on_error(j_common_ptr info) {
    auto* errors = reinterpret_cast<JpegErrors*>(info->err);
    errors->manager.format_message(info, errors->message);
    std::longjmp(errors->jump, 1);
}

/// libjpeg mends damage with grey and calls it a warning; we refuse it, except for what harms no pixel.
void on_message(j_common_ptr info, int level) {
    if (level >= 0) return;  // a trace
    const int code = info->err->msg_code;
    if (code != JWRN_EXTRANEOUS_DATA && code != JWRN_JFIF_MAJOR && code != JWRN_ADOBE_XFORM) on_error(info);
}

void print_nothing(j_common_ptr) {}

/// A small progressive file can name thousands of scans and keep us busy for hours.
void limit_scans(j_common_ptr info) {
    constexpr int most_scans = 500;
    if (reinterpret_cast<j_decompress_ptr>(info)->input_scan_number > most_scans)
        ERREXIT(info, JERR_BAD_PROGRESSION);
}

/// libjpeg's structure for reading one file.
class JpegReader {
  public:
    explicit JpegReader(const std::string& name) : name_(name) {
        info_.err = jpeg_std_error(&errors_.manager);
        errors_.manager.error_exit = on_error;
        errors_.manager.emit_message = on_message;
        errors_.manager.output_message = print_nothing;
        progress_.progress_monitor = limit_scans;
        run([](j_decompress_ptr info) { jpeg_create_decompress(info); });
        info_.progress = &progress_;
    }
    ~JpegReader() { jpeg_destroy_decompress(&info_); }
    JpegReader(const JpegReader&) = delete;
    JpegReader& operator=(const JpegReader&) = delete;

    /// Throws ImageError where libjpeg gives up. `calls` must not own anything: the jump skips its
    /// destructors.
    template <typename Calls>
    void run(const Calls& calls) {
        if (!survives(calls)) fail_image(name_, "an undamaged JPEG file", errors_.message);
    }
    [[nodiscard]] const jpeg_decompress_struct& info() const { return info_; }

  private:
    template <typename Calls>
    bool survives(const Calls& calls) {
        if (setjmp(errors_.jump) != 0) return false;
        calls(&info_);
        return true;
    }

    std::string name_;
    jpeg_decompress_struct info_{};
    JpegErrors errors_;
    jpeg_progress_mgr progress_{};
};

bool is_cmyk(const jpeg_decompress_struct& info) {
    return info.jpeg_color_space == JCS_CMYK || info.jpeg_color_space == JCS_YCCK;
}

void check_color_space(const jpeg_decompress_struct& info, const std::string& name) {
    if (info.jpeg_color_space == JCS_UNKNOWN)
        fail_image(name, "grey, RGB or CMYK", std::to_string(info.num_components) + " unnamed channels");
}

/// One pixel of ink to light. Adobe stores what is left white: 255 − C.
void cmyk_to_rgba(const JSAMPLE* cmyk, bool inverted, std::uint8_t* rgba) {
    const auto white = [&](int i) { return static_cast<unsigned>(inverted ? cmyk[i] : 255 - cmyk[i]); };
    for (int i = 0; i < 3; ++i) rgba[i] = static_cast<std::uint8_t>((white(i) * white(3) + 127) / 255);
    rgba[3] = 255;
}

void rgb_to_rgba(const JSAMPLE* rgb, std::uint8_t* rgba) {
    for (int i = 0; i < 3; ++i) rgba[i] = rgb[i];
    rgba[3] = 255;
}

/// Decodes every row; `row` holds one, `rgba` all of them.
void read_rows(j_decompress_ptr info, JSAMPLE* row, std::uint8_t* rgba) {
    const bool cmyk = is_cmyk(*info);
    info->out_color_space = cmyk ? JCS_CMYK : JCS_RGB;
    jpeg_start_decompress(info);
    while (info->output_scanline < info->output_height) {
        jpeg_read_scanlines(info, &row, 1);
        for (std::size_t x = 0; x < info->output_width; ++x, rgba += 4) {
            if (cmyk)
                cmyk_to_rgba(row + 4 * x, info->saw_Adobe_marker != 0, rgba);
            else
                rgb_to_rgba(row + 3 * x, rgba);
        }
    }
    jpeg_finish_decompress(info);
}

}  // namespace

bool is_jpeg(std::span<const std::uint8_t> bytes) { return starts_with(bytes, "\xff\xd8\xff"); }

ByteImage decode_jpeg(std::span<const std::uint8_t> encoded, const std::string& name) {
    JpegReader reader(name);
    reader.run([&](j_decompress_ptr info) {
        jpeg_mem_src(info, encoded.data(), static_cast<unsigned long>(encoded.size()));
        jpeg_read_header(info, TRUE);
    });
    const std::size_t width = reader.info().image_width, height = reader.info().image_height;
    check_image_size(static_cast<std::int64_t>(width), static_cast<std::int64_t>(height), name);
    check_color_space(reader.info(), name);
    check_packed_size(width * height, encoded.size(), name);  // a bit at least for each 64 pixels

    ByteImage image{static_cast<int>(width), static_cast<int>(height), {}, {}};
    image.rgba8.resize(4 * width * height);
    std::vector<JSAMPLE> row(4 * width);
    reader.run([&](j_decompress_ptr info) { read_rows(info, row.data(), image.rgba8.data()); });
    return image;
}

}  // namespace relumine
