// SPDX-License-Identifier: Apache-2.0
// From radiance to the bytes of a picture for the screen.
#pragma once

#include <cstdint>
#include <vector>

#include "relumine/image.hpp"

namespace relumine {

/// The picture itself times 2^exposure as 8-bit sRGB, 3 × width × height. What lies between two bytes is
/// dithered: it becomes either, at random but always the same, so that the mean of an even area is kept.
/// Black, white and whatever a byte holds exactly stay exact. NaN becomes black, +inf white.
[[nodiscard]] std::vector<std::uint8_t> quantize(const Image& image, float exposure);

}  // namespace relumine
