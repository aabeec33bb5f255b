// SPDX-License-Identifier: Apache-2.0
// Maps from the unit square to directions and triangles.
#pragma once

#include "base/frame.hpp"

namespace relumine {

/// Square to disk, area-preserving and with little distortion [Shirley97].
inline Point2 concentric_disk(Point2 u) {
    const float x = 2 * u.x - 1, y = 2 * u.y - 1;
    if (x == 0 && y == 0) return {};
    const bool wide = std::abs(x) > std::abs(y);
    const float r = wide ? x : y;
    const float phi = wide ? (pi / 4) * (y / x) : (pi / 2) - (pi / 4) * (x / y);
    return {r * std::cos(phi), r * std::sin(phi)};
}

/// Density cos θ / π.
inline LocalDir cosine_hemisphere(Point2 u) {
    const Point2 d = concentric_disk(u);
    return {{d.x, d.y, std::sqrt(std::max(0.0f, 1 - sqr(d.x) - sqr(d.y)))}};
}

/// Barycentric weights of the second and third corner, uniform over the triangle's area, low distortion
/// [Heitz19].
inline Point2 uniform_triangle(Point2 u) {
    if (u.y > u.x) return {0.5f * u.x, u.y - 0.5f * u.x};
    return {u.x - 0.5f * u.y, 0.5f * u.y};
}

/// Veach's power heuristic with exponent 2 for one sample of each strategy [Veach97, §9.2.4].
inline float mis_weight(float pdf, float other_pdf) {
    const float ratio = other_pdf / pdf;
    return 1 / (1 + sqr(ratio));
}

}  // namespace relumine
