// SPDX-License-Identifier: Apache-2.0
// Radiance pictures. Ours and not stb_image's, which takes a picture without its end for a whole one.
#include "image/hdr.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <string_view>
#include <vector>

#include "image/check.hpp"
#include "image/picture.hpp"

namespace relumine {
namespace {

using Rgbe = std::array<std::uint8_t, 4>;

/// Reads forward through the file; throws at its end.
class HdrReader {
  public:
    HdrReader(std::span<const std::uint8_t> bytes, const std::string& name) : bytes_(bytes), name_(name) {}

    std::uint8_t take() {
        if (bytes_.empty()) fail("a whole HDR picture", "an early end");
        const std::uint8_t byte = bytes_.front();
        bytes_ = bytes_.subspan(1);
        return byte;
    }
    Rgbe take_rgbe() { return {take(), take(), take(), take()}; }
    std::string_view take_line() {
        const auto end = std::ranges::find(bytes_, static_cast<std::uint8_t>('\n'));
        if (end == bytes_.end()) fail("a whole HDR header", "an early end");
        const auto length = static_cast<std::size_t>(end - bytes_.begin());
        const std::string_view line{reinterpret_cast<const char*>(bytes_.data()), length};
        bytes_ = bytes_.subspan(length + 1);
        return line.ends_with('\r') ? line.substr(0, length - 1) : line;
    }
    [[nodiscard]] std::span<const std::uint8_t> rest() const { return bytes_; }
    [[noreturn]] void fail(std::string_view expected, std::string_view found) const {
        fail_image(name_, expected, found);
    }
    [[nodiscard]] const std::string& name() const { return name_; }

  private:
    std::span<const std::uint8_t> bytes_;
    std::string name_;
};

std::string quoted(std::string_view text) { return fmt::format("\"{}\"", text.substr(0, 60)); }

/// "#?RADIANCE", then comments and variables up to an empty line.
void take_variables(HdrReader& reader) {
    for (std::string_view line = reader.take_line(); !line.empty(); line = reader.take_line())
        if (line.starts_with("FORMAT=") && line != "FORMAT=32-bit_rle_rgbe")
            reader.fail("FORMAT=32-bit_rle_rgbe", quoted(line));
}

/// Takes "-Y 480" or the like off the line; −1 where it says something else.
std::int64_t take_side(std::string_view& line, std::string_view axis) {
    if (!line.starts_with(axis)) return -1;
    std::int64_t side = -1;
    const char* end = line.data() + line.size();
    const auto [rest, error] = std::from_chars(line.data() + axis.size(), end, side);
    line = {rest, static_cast<std::size_t>(end - rest)};
    return error == std::errc{} ? side : -1;
}

struct HdrSize {
    std::size_t width = 0, height = 0;  // pixels
};

HdrSize take_size(HdrReader& reader) {
    const std::string_view line = reader.take_line();
    std::string_view left = line;
    const std::int64_t height = take_side(left, "-Y "), width = take_side(left, " +X ");
    if (height < 0 || width < 0 || !left.empty()) reader.fail("\"-Y height +X width\"", quoted(line));
    check_image_size(width, height, reader.name());
    return {static_cast<std::size_t>(width), static_cast<std::size_t>(height)};
}

/// Whether the next row is coded channel by channel: 2, 2 and the width in its first four bytes.
bool is_planar_row(const HdrReader& reader, std::size_t width) {
    const std::span<const std::uint8_t> head = reader.rest();
    return width >= 8 && width < 32768 && head.size() >= 4 && head[0] == 2 && head[1] == 2
           && (std::size_t{head[2]} << 8 | head[3]) == width;
}

/// One channel of a row: runs (128 + length, byte) and stretches (length, bytes…).
void take_planar_channel(HdrReader& reader, std::vector<Rgbe>& row, std::size_t channel) {
    for (std::size_t x = 0; x < row.size();) {
        const std::uint8_t code = reader.take();
        const std::size_t length = code > 128 ? code - 128u : code;
        if (length == 0 || length > row.size() - x)
            reader.fail(fmt::format("a run of 1 to {} pixels", row.size() - x), fmt::format("{}", length));
        const bool same = code > 128;
        const std::uint8_t value = same ? reader.take() : std::uint8_t{0};
        for (std::size_t i = 0; i < length; ++i) row[x++][channel] = same ? value : reader.take();
    }
}

/// A row of whole pixels, in which (1, 1, 1, n) repeats the last one; n of consecutive repeats are its
/// digits, base 256.
void take_flat_row(HdrReader& reader, std::vector<Rgbe>& row) {
    std::size_t repeats = 0;  // in a row
    for (std::size_t x = 0; x < row.size();) {
        const Rgbe pixel = reader.take_rgbe();
        const bool repeat = pixel[0] == 1 && pixel[1] == 1 && pixel[2] == 1;
        if (!repeat) {
            row[x++] = pixel;
            repeats = 0;
            continue;
        }
        const std::size_t length = repeats < 3 ? std::size_t{pixel[3]} << (8 * repeats) : row.size();
        if (x == 0 || length > row.size() - x)
            reader.fail("a run that fits its row", fmt::format("{} pixels", length));
        std::fill_n(row.begin() + static_cast<std::ptrdiff_t>(x), length, row[x - 1]);
        x += length;
        ++repeats;
    }
}

void take_row(HdrReader& reader, std::vector<Rgbe>& row) {
    if (!is_planar_row(reader, row.size())) return take_flat_row(reader, row);
    (void)reader.take_rgbe();
    for (std::size_t channel = 0; channel < 4; ++channel) take_planar_channel(reader, row, channel);
}

void append_linear(std::vector<float>& pixels, const Rgbe& pixel) {
    const int exponent = pixel[3] - (128 + 8);
    for (std::size_t c = 0; c < 3; ++c)
        pixels.push_back(pixel[3] == 0 ? 0.0f : std::ldexp(static_cast<float>(pixel[c]), exponent));
}

}  // namespace

bool is_hdr(std::span<const std::uint8_t> bytes) {
    return starts_with(bytes, "#?RADIANCE") || starts_with(bytes, "#?RGBE");
}

Image decode_hdr(std::span<const std::uint8_t> encoded, const std::string& name) {
    HdrReader reader(encoded, name);
    take_variables(reader);
    const HdrSize size = take_size(reader);
    if (size.height * 4 > reader.rest().size())  // no row is shorter than that
        reader.fail(fmt::format("at least {} bytes of pixels", size.height * 4),
                    fmt::format("{}", reader.rest().size()));
    std::vector<float> pixels;  // grows with what the file really holds
    std::vector<Rgbe> row(size.width);
    for (std::size_t y = 0; y < size.height; ++y) {
        take_row(reader, row);
        for (const Rgbe& pixel : row) append_linear(pixels, pixel);
    }
    return make_picture(static_cast<int>(size.width), static_cast<int>(size.height), {"R", "G", "B"},
                        std::move(pixels));
}

}  // namespace relumine
