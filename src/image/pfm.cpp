// SPDX-License-Identifier: Apache-2.0
// Portable float maps.
#include "image/pfm.hpp"

#include <fmt/format.h>

#include <bit>
#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>

#include "base/assert.hpp"
#include "image/check.hpp"
#include "image/picture.hpp"

namespace relumine {
namespace {

constexpr std::size_t float_bytes = 4;

bool is_space(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

/// The next word of the header and the one character that ends it; a word that never ends comes back empty.
std::string_view take_word(std::string_view& text) {
    while (!text.empty() && is_space(text.front())) text.remove_prefix(1);
    std::size_t length = 0;
    while (length < text.size() && !is_space(text[length])) ++length;
    if (length == text.size()) return {};
    const std::string_view word = text.substr(0, length);
    text.remove_prefix(length + 1);
    return word;
}

template <typename Number>
std::optional<Number> parse(std::string_view word) {
    Number value{};
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc{} || end != word.data() + word.size()) return std::nullopt;
    return value;
}

std::string quoted(std::string_view word) {
    return word.empty() ? "the end of the header" : fmt::format("\"{}\"", word.substr(0, 40));
}

std::int64_t take_side(std::string_view& text, const std::string& name) {
    const std::string_view word = take_word(text);
    const auto side = parse<std::int64_t>(word);
    if (!side) fail_image(name, "a width and a height in pixels", quoted(word));
    return *side;
}

float take_scale(std::string_view& text, const std::string& name) {
    const std::string_view word = take_word(text);
    const auto scale = parse<float>(word);
    if (!scale || !std::isfinite(*scale) || *scale == 0)
        fail_image(name, "a finite scale other than 0", quoted(word));
    return *scale;
}

struct PfmHeader {
    std::size_t width = 0, height = 0, channels = 0;
    float scale = 1;  // negative: little-endian

    [[nodiscard]] std::size_t row_values() const { return width * channels; }
};

/// Leaves the pixels in `text`.
PfmHeader take_header(std::string_view& text, const std::string& name) {
    PfmHeader header;
    header.channels = take_word(text) == "PF" ? 3 : 1;
    const std::int64_t width = take_side(text, name), height = take_side(text, name);
    check_image_size(width, height, name);
    header.width = static_cast<std::size_t>(width);
    header.height = static_cast<std::size_t>(height);
    header.scale = take_scale(text, name);
    return header;
}

std::uint32_t load_u32(const char* bytes, bool little_endian) {
    std::uint32_t value = 0;
    for (unsigned i = 0; i < float_bytes; ++i) {
        const unsigned shift = 8 * (little_endian ? i : 3 - i);
        value |= static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[i])) << shift;
    }
    return value;
}

std::vector<float> decode_rows(const PfmHeader& header, std::string_view stored) {
    std::vector<float> pixels;
    pixels.reserve(header.height * header.row_values());
    for (std::size_t y = header.height; y-- > 0;) {
        const char* row = stored.data() + y * header.row_values() * float_bytes;
        for (std::size_t i = 0; i < header.row_values(); ++i) {
            const auto value = std::bit_cast<float>(load_u32(row + i * float_bytes, header.scale < 0));
            pixels.push_back(value * std::abs(header.scale));
        }
    }
    return pixels;
}

void append_float(std::vector<std::uint8_t>& bytes, float value) {
    const auto bits = std::bit_cast<std::uint32_t>(value);
    for (unsigned shift = 0; shift < 32; shift += 8)
        bytes.push_back(static_cast<std::uint8_t>(bits >> shift));
}

}  // namespace

bool is_pfm(std::span<const std::uint8_t> bytes) {
    return bytes.size() >= 3 && bytes[0] == 'P' && (bytes[1] == 'F' || bytes[1] == 'f')
           && is_space(static_cast<char>(bytes[2]));
}

Image decode_pfm(std::span<const std::uint8_t> encoded, const std::string& name) {
    std::string_view text{reinterpret_cast<const char*>(encoded.data()), encoded.size()};
    const PfmHeader header = take_header(text, name);
    const std::size_t expected = header.height * header.row_values() * float_bytes;
    if (text.size() < expected)
        fail_image(name, fmt::format("{} bytes of pixels", expected), fmt::format("{}", text.size()));
    auto channels =
        header.channels == 3 ? std::vector<std::string>{"R", "G", "B"} : std::vector<std::string>{"Y"};
    return make_picture(static_cast<int>(header.width), static_cast<int>(header.height), std::move(channels),
                        decode_rows(header, text));
}

std::vector<std::uint8_t> encode_pfm(const Image& image) {
    const Layer* picture = image.layer();
    RELUMINE_ASSERT(picture);
    const std::size_t channels = picture->channels.size() == 1 ? 1 : 3;
    const std::string header =
        fmt::format("{}\n{} {}\n-1.0\n", channels == 1 ? "Pf" : "PF", image.width, image.height);
    std::vector<std::uint8_t> bytes(header.begin(), header.end());
    for (int y = image.height; y-- > 0;)
        for (int x = 0; x < image.width; ++x) {
            const std::array<float, 3> rgb = image.rgb(x, y);
            for (std::size_t c = 0; c < channels; ++c) append_float(bytes, rgb[c]);
        }
    return bytes;
}

}  // namespace relumine
