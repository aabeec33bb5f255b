// SPDX-License-Identifier: Apache-2.0
// Irradiance from the strata of a hemisphere, and how it changes as the surface turns and moves [Ward92].
#pragma once

#include "rivals/polar_hemisphere.hpp"

namespace relumine {

/// The derivative of a spectrum by a vector, per channel.
struct Gradient {
    Vec3 r, g, b;

    [[nodiscard]] Spectrum along(Vec3 d) const { return {dot(r, d), dot(g, d), dot(b, d)}; }
    void add(Spectrum value, Vec3 direction) {
        r += direction * value.r;
        g += direction * value.g;
        b += direction * value.b;
    }
    friend Gradient operator*(const Gradient& a, float s) { return {a.r * s, a.g * s, a.b * s}; }
};

/// Irradiance on a surface, W·m⁻², and its derivatives, world space.
struct Irradiance {
    Spectrum value;
    Gradient rotation;     // by n × n′ for a normal that turns from n to n′
    Gradient translation;  // 1/metre, by the way gone in the tangent plane
};

/// The irradiance that light straight from lights and light from surfaces make.
struct SplitIrradiance {
    Irradiance direct, indirect;

    [[nodiscard]] Spectrum value() const { return direct.value + indirect.value; }
};

/// Of a hemisphere with Rings::cosine around `frame`.
[[nodiscard]] SplitIrradiance irradiance_of(const PolarHemisphere& hemisphere, const Frame& frame);

/// What is expected at a point `offset` away whose normal is `normal`: at least black.
[[nodiscard]] Spectrum extrapolated(const Irradiance& at, Vec3 record_normal, Vec3 offset, Vec3 normal);

/// The length within which irradiance changes by all of itself, |E| / |∇E|, metres; infinite without change.
[[nodiscard]] float change_length(const SplitIrradiance& at);

}  // namespace relumine
