// SPDX-License-Identifier: Apache-2.0
// Portable float maps: "PF" (RGB) or "Pf" (grey), width, height, scale, then 32-bit floats, bottom row first.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "relumine/image.hpp"

namespace relumine {

[[nodiscard]] bool is_pfm(std::span<const std::uint8_t> bytes);

/// Both byte orders; pixels are multiplied by the magnitude of the scale. Throws ImageError with `name` in
/// front.
[[nodiscard]] Image decode_pfm(std::span<const std::uint8_t> encoded, const std::string& name);

/// The picture itself, little-endian: "Pf" where it has one channel, else "PF".
[[nodiscard]] std::vector<std::uint8_t> encode_pfm(const Image& image);

}  // namespace relumine
