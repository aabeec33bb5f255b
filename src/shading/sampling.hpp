// SPDX-License-Identifier: Apache-2.0
// Maps from the unit square to directions and triangles.
#pragma once

#include <cstdint>

#include "base/frame.hpp"

namespace relumine {

struct SineCosine {
    float sine, cosine;
};

/// For |x| ≤ π/4, to 1e-7; Taylor's polynomials end where floats do.
inline SineCosine sine_cosine_of_octant(float x) {
    const float x2 = sqr(x);
    const float sine = 1 - x2 * (1.0f / 6 - x2 * (1.0f / 120 - x2 * (1.0f / 5040 - x2 * (1.0f / 362880))));
    const float cosine =
        1
        - x2
              * (1.0f / 2
                 - x2 * (1.0f / 24 - x2 * (1.0f / 720 - x2 * (1.0f / 40320 - x2 * (1.0f / 3628800)))));
    return {x * sine, cosine};
}

/// Of the angle 2π `turns`, for turns in [0, 1], to 2e-7.
inline SineCosine sine_cosine_of_turns(float turns) {
    const auto quarter = static_cast<std::int32_t>(4 * turns + 0.5f);  // the nearest
    const auto [sine, cosine] =
        sine_cosine_of_octant((2 * pi) * (turns - 0.25f * static_cast<float>(quarter)));
    const bool swapped = (quarter & 1) != 0;
    const float s = swapped ? cosine : sine, c = swapped ? sine : cosine;
    return {(quarter & 2) != 0 ? -s : s, ((quarter + 1) & 2) != 0 ? -c : c};
}

/// Square to disk, area-preserving and with little distortion [Shirley97].
inline Point2 concentric_disk(Point2 u) {
    const float x = 2 * u.x - 1, y = 2 * u.y - 1;
    if (x == 0 && y == 0) return {};
    const bool wide = std::abs(x) > std::abs(y);
    const float r = wide ? x : y;
    const auto [sine, cosine] = sine_cosine_of_octant((pi / 4) * (wide ? y / x : x / y));
    return {r * (wide ? cosine : sine), r * (wide ? sine : cosine)};
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
