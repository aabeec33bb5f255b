// SPDX-License-Identifier: Apache-2.0
// The equal-area mapping between directions and the unit square, folded like an octahedron [Clarberg08].
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "base/vec.hpp"

namespace relumine {

/// A unit direction's place in [0, 1]²: +Z in the middle, −Z in the corners, +X at the right.
inline Vec2 equal_area_square(const std::array<double, 3>& d) {
    constexpr double half_pi = 1.57079632679489661923;
    const double r = std::sqrt(std::max(0.0, 1 - std::abs(d[2])));
    double v = std::atan2(std::abs(d[1]), std::abs(d[0])) / half_pi * r, u = r - v;
    if (d[2] < 0) {
        std::swap(u, v);
        u = 1 - u;
        v = 1 - v;
    }
    u = std::copysign(u, d[0]);
    v = std::copysign(v, d[1]);
    return {static_cast<float>((u + 1) / 2), static_cast<float>((v + 1) / 2)};
}

/// The unit direction at a place in [0, 1]².
inline std::array<double, 3> equal_area_direction(double s, double t) {
    constexpr double quarter_pi = 0.78539816339744830962;
    const double u = 2 * s - 1, v = 2 * t - 1, up = std::abs(u), vp = std::abs(v);
    const double to_diagonal = 1 - (up + vp), r = 1 - std::abs(to_diagonal);
    const double phi = (r == 0 ? 1 : (vp - up) / r + 1) * quarter_pi;
    const double across = r * std::sqrt(std::max(0.0, 2 - r * r));
    return {std::copysign(std::cos(phi), u) * across, std::copysign(std::sin(phi), v) * across,
            std::copysign(1 - r * r, to_diagonal)};
}

}  // namespace relumine
