// SPDX-License-Identifier: Apache-2.0
// The sRGB transfer curve [IEC61966], both ways.
#pragma once

#include <cmath>

namespace relumine {

/// Linear light in [0, 1] of an encoded value in [0, 1].
inline double linear_from_srgb(double encoded) {
    return encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}

/// The encoded value in [0, 1] of linear light in [0, 1].
inline double srgb_from_linear(double linear) {
    return linear <= 0.0031308 ? linear * 12.92 : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}

}  // namespace relumine
