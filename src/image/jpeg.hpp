// SPDX-License-Identifier: Apache-2.0
// JPEG of grey, RGB or CMYK, sequential or progressive, by libjpeg.
#pragma once

#include "image/byte_image.hpp"

namespace relumine {

[[nodiscard]] bool is_jpeg(std::span<const std::uint8_t> bytes);

/// Fills `rgba8`; alpha is opaque. Throws ImageError with `name` in front, also for a file that merely lacks
/// its end.
[[nodiscard]] ByteImage decode_jpeg(std::span<const std::uint8_t> encoded, const std::string& name);

}  // namespace relumine
