// SPDX-License-Identifier: Apache-2.0
// Pictures of small integers, as textures are stored: decoding PNG, JPEG and WebP from memory, encoding PNG.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace relumine {

inline constexpr int max_image_side = 65536;                           // pixels
inline constexpr std::size_t max_image_pixels = std::size_t{1} << 28;  // 268 million

/// RGBA, 8 or 16 bits per channel, top row first, as encoded: no colour transform.
/// Grey is replicated, missing alpha is opaque, CMYK becomes RGB. Exactly one of the two arrays is filled.
struct ByteImage {
    int width = 0, height = 0;
    std::vector<std::uint8_t> rgba8;    // 4 × width × height, or empty
    std::vector<std::uint16_t> rgba16;  // 4 × width × height in native byte order, or empty
};

/// Decodes PNG, JPEG or WebP by content. Throws ImageError with `name` in front: unknown format, damage, or
/// too many pixels.
[[nodiscard]] ByteImage decode_byte_image(std::span<const std::uint8_t> encoded, const std::string& name);

/// Encodes 8-bit RGB, row-major, 3 × width × height bytes, with an sRGB chunk.
[[nodiscard]] std::vector<std::uint8_t> encode_png(int width, int height, std::span<const std::uint8_t> rgb);

}  // namespace relumine
