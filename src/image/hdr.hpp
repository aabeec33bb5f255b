// SPDX-License-Identifier: Apache-2.0
// Radiance pictures: 8-bit mantissas of red, green and blue with a common exponent, flat or run-length coded
// [Ward91].
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "relumine/image.hpp"

namespace relumine {

[[nodiscard]] bool is_hdr(std::span<const std::uint8_t> bytes);

/// RGB as stored: EXPOSURE is not undone. Throws ImageError with `name` in front; XYZE and rotated pictures
/// are refused.
[[nodiscard]] Image decode_hdr(std::span<const std::uint8_t> encoded, const std::string& name);

}  // namespace relumine
