// SPDX-License-Identifier: Apache-2.0
// The map between the unit square and the hemisphere: concentric [Shirley97], uniform in solid angle [V,
// §3.1].
//
// dω = 2π du dv everywhere. The square's border is the horizon; points a little beyond it stand for
// directions below the horizon, so that what straddles the horizon projects without a special case.
#pragma once

#include <array>

#include "shading/sampling.hpp"

namespace relumine {

/// Solid angle of the whole square, steradian.
inline constexpr float hemisphere_solid_angle = 2 * pi;

/// (4/π)·atan(x) / x as a polynomial in x², |x| ≤ 1; the error of the angle is below 5e-7 of an octant. The
/// same operations in the same order as the kernels', so that both give the same bits.
inline constexpr std::array<float, 7> octant_polynomial{
    1.27323459f, -0.42420987f, 0.252200646f, -0.168491105f, 0.101378236f, -0.0427847775f, 0.00867259245f};

/// The same to 1.1e-4 of an octant, for the corners of surfels: at most 1/140 bit of a mask, where half
/// floats leave 1/40.
inline constexpr std::array<float, 4> short_octant_polynomial{1.27223849f, -0.408932656f, 0.186229676f,
                                                              -0.0496391580f};

template <std::size_t terms>
float octant(float x, const std::array<float, terms>& polynomial) {
    const float x2 = x * x;
    float sum = polynomial.back();
    for (std::size_t i = terms - 1; i-- > 0;) sum = sum * x2 + polynomial[i];
    return sum * x;
}
inline float octant(float x) { return octant(x, octant_polynomial); }

/// From [0, 1]² to the hemisphere z ≥ 0 around the frame's normal.
inline LocalDir square_to_hemisphere(Point2 p) {
    const Point2 disk = concentric_disk(p);
    const float r2 = sqr(disk.x) + sqr(disk.y);
    const float stretch = std::sqrt(std::max(0.0f, 2 - r2));
    return {{disk.x * stretch, disk.y * stretch, 1 - r2}};
}

/// The inverse; directions with z < 0 end outside [0, 1]², at most 0.21 beyond it.
inline Point2 hemisphere_to_square(LocalDir w) {
    const float r = std::sqrt(std::max(0.0f, 1 - w.v.z));
    const float ax = std::abs(w.v.x), ay = std::abs(w.v.y);
    const float major = std::max(ax, ay), minor = std::min(ax, ay);
    const float along = r, across = r * octant(minor / std::max(major, 1e-30f));
    const float x = std::copysign(ax >= ay ? along : across, w.v.x);
    const float y = std::copysign(ax >= ay ? across : along, w.v.y);
    return {0.5f * x + 0.5f, 0.5f * y + 0.5f};
}

}  // namespace relumine
