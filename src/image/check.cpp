// SPDX-License-Identifier: Apache-2.0
// What every decoder refuses, and in which words.
#include "image/check.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/message.hpp"
#include "image/byte_image.hpp"
#include "relumine/error.hpp"

namespace relumine {

void fail_image(const std::string& name, std::string_view expected, std::string_view found) {
    std::string line{found};
    std::ranges::replace_if(
        line, [](char c) { return static_cast<unsigned char>(c) < ' '; }, ' ');
    throw ImageError{expected_found(name, expected, line)};
}

void check_image_size(std::int64_t width, std::int64_t height, const std::string& name) {
    const auto fits = [](std::int64_t side) { return side >= 1 && side <= max_image_side; };
    if (fits(width) && fits(height) && static_cast<std::uint64_t>(width * height) <= max_image_pixels) return;
    const std::string expected =
        fmt::format("1 to {} pixels a side and at most {} pixels", max_image_side, max_image_pixels);
    fail_image(name, expected, fmt::format("{} x {} pixels", width, height));
}

void check_packed_size(std::uint64_t samples_bytes, std::size_t size, const std::string& name) {
    constexpr std::uint64_t densest = 1100;  // bytes unpacked per byte of file
    if (samples_bytes / densest <= size) return;
    fail_image(name, fmt::format("at least {} bytes for so many pixels", samples_bytes / densest),
               fmt::format("{} bytes", size));
}

bool starts_with(std::span<const std::uint8_t> bytes, std::string_view magic) {
    return bytes.size() >= magic.size()
           && std::equal(magic.begin(), magic.end(), bytes.begin(),
                         [](char a, std::uint8_t b) { return static_cast<std::uint8_t>(a) == b; });
}

}  // namespace relumine
