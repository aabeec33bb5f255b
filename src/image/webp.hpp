// SPDX-License-Identifier: Apache-2.0
// WebP, lossy or lossless, by libwebp.
#pragma once

#include "image/byte_image.hpp"

namespace relumine {

[[nodiscard]] bool is_webp(std::span<const std::uint8_t> bytes);

/// Fills `rgba8`. Throws ImageError with `name` in front, also for animations and for a file that merely
/// lacks its end.
[[nodiscard]] ByteImage decode_webp(std::span<const std::uint8_t> encoded, const std::string& name);

}  // namespace relumine
