// SPDX-License-Identifier: Apache-2.0
// OpenEXR: single-part scanline or tiled files. Channel "albedo.R" is channel R of layer "albedo"; R alone
// belongs to the picture itself.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "relumine/image.hpp"

namespace relumine {

[[nodiscard]] bool is_exr(std::span<const std::uint8_t> bytes);

/// All layers as floats, string attributes as metadata. Throws ImageError with `name` in front; deep,
/// multi-part and subsampled files are refused.
[[nodiscard]] Image decode_exr(std::span<const std::uint8_t> encoded, const std::string& name);

/// All layers, ZIP-compressed. With `half_floats`, channels R, G, B and A have 16 bits; finite values too
/// large for them become the largest one. Throws SettingsError for metadata or layers that EXR cannot name.
[[nodiscard]] std::vector<std::uint8_t> encode_exr(const Image& image, bool half_floats);

}  // namespace relumine
