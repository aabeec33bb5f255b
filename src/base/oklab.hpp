// SPDX-License-Identifier: Apache-2.0
// Colours in which equal steps look equally large, for pictures that show numbers.
#pragma once

#include <algorithm>

#include "base/vec.hpp"

namespace relumine {

/// Linear Rec. 709 of an Oklab colour [Ottosson20], clipped to the gamut.
inline Spectrum rgb_from_oklab(float lightness, float a, float b) {
    const float l = lightness + 0.3963377774f * a + 0.2158037573f * b;
    const float m = lightness - 0.1055613458f * a - 0.0638541728f * b;
    const float s = lightness - 0.0894841775f * a - 1.2914855480f * b;
    const float l3 = l * l * l, m3 = m * m * m, s3 = s * s * s;
    const auto clip = [](float value) { return std::clamp(value, 0.0f, 1.0f); };
    return {clip(4.0767416621f * l3 - 3.3077115913f * m3 + 0.2309699292f * s3),
            clip(-1.2684380046f * l3 + 2.6097574011f * m3 - 0.3413193965f * s3),
            clip(-0.0041960863f * l3 - 0.7034186147f * m3 + 1.7076147010f * s3)};
}

}  // namespace relumine
