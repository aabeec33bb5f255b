// SPDX-License-Identifier: Apache-2.0
// Radiance in 32 bits: three 8-bit mantissas and a shared exponent [Ward91], rounded to nearest.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>

#include "base/vec.hpp"

namespace relumine {

/// Least exponent byte that is not black: 2⁻¹²⁶, so that decoding needs no denormals.
inline constexpr int least_rgbe_exponent = 10;

/// Finite, non-negative radiance to RGBE: relative error ≤ 1/255 of the largest channel; 0 stays 0.
inline std::uint32_t pack_rgbe(Spectrum s) {
    int exponent = 0;
    std::frexp(max_component(s), &exponent);
    if (std::ldexp(max_component(s), 8 - exponent) >= 255.5f) ++exponent;
    exponent = std::min(exponent, 127);
    if (!(max_component(s) > 0) || exponent + 128 < least_rgbe_exponent) return 0;
    const auto mantissa = [&](float channel) {
        return static_cast<std::uint32_t>(
            std::min(std::ldexp(std::max(channel, 0.0f), 8 - exponent) + 0.5f, 255.0f));
    };
    return mantissa(s.r) | mantissa(s.g) << 8 | mantissa(s.b) << 16
           | static_cast<std::uint32_t>(exponent + 128) << 24;
}

inline Spectrum unpack_rgbe(std::uint32_t packed) {
    const std::uint32_t exponent = packed >> 24;
    if (exponent < least_rgbe_exponent) return {};
    const float unit = std::bit_cast<float>((exponent - 9) << 23);  // 2^(exponent − 136)
    return Spectrum{static_cast<float>(packed & 255), static_cast<float>(packed >> 8 & 255),
                    static_cast<float>(packed >> 16 & 255)}
           * unit;
}

}  // namespace relumine
