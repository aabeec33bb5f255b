// SPDX-License-Identifier: Apache-2.0
// PNG of every bit depth and colour type, by libpng. Encoding is declared in byte_image.hpp.
#pragma once

#include "image/byte_image.hpp"

namespace relumine {

[[nodiscard]] bool is_png(std::span<const std::uint8_t> bytes);

/// 16-bit files fill `rgba16`, all others `rgba8`. Throws ImageError with `name` in front.
[[nodiscard]] ByteImage decode_png(std::span<const std::uint8_t> encoded, const std::string& name);

}  // namespace relumine
