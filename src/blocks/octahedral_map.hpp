// SPDX-License-Identifier: Apache-2.0
// The map between the unit square and the sphere of directions: octahedral, uniform in solid angle
// [Clarberg08].
//
// dω = 4π du dv everywhere; +z is the square's centre, −z its four corners, and the diagonal square between
// is the equator. Its axes are the world's, so that maps of any two points lie on top of each other.
#pragma once

#include "cache/hemisphere_map.hpp"

namespace relumine {

/// Solid angle of the whole square, steradian.
inline constexpr float sphere_solid_angle = 4 * pi;

/// From [0, 1]² to the sphere.
inline WorldDir square_to_sphere(Point2 p) {
    const float u = 2 * p.x - 1, v = 2 * p.y - 1;
    const float au = std::abs(u), av = std::abs(v), height = 1 - (au + av);
    const float r = 1 - std::abs(height);
    const float eighth = r > 0 ? (av - au) / r : 0.0f;  // −1 … 1: the angle from the diagonal, in octants
    const auto [sine, cosine] = sine_cosine_of_octant(eighth * (pi / 4));
    constexpr float root_half = 0.70710678118654752440f;
    const float across = r * std::sqrt(std::max(0.0f, 2 - r * r));
    return {{std::copysign((cosine - sine) * root_half * across, u),
             std::copysign((cosine + sine) * root_half * across, v), std::copysign(1 - r * r, height)}};
}

/// The inverse. A direction on the fold may end on either of the edges that meet there.
inline Point2 sphere_to_square(WorldDir w) {
    const float ax = std::abs(w.v.x), ay = std::abs(w.v.y);
    const float r = std::sqrt(std::max(0.0f, 1 - std::abs(w.v.z)));
    const float major = std::max(ax, ay), minor = std::min(ax, ay);
    float angle = 0.5f * octant(minor / std::max(major, 1e-30f));  // 0 … ½: of the quarter turn from x to y
    if (ax < ay) angle = 1 - angle;
    float v = angle * r, u = r - v;
    if (w.v.z < 0) {
        const float folded = 1 - v;
        v = 1 - u;
        u = folded;
    }
    return {0.5f * std::copysign(u, w.v.x) + 0.5f, 0.5f * std::copysign(v, w.v.y) + 0.5f};
}

}  // namespace relumine
