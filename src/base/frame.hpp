// SPDX-License-Identifier: Apache-2.0
// Directions that know their space, and the orthonormal frames between them.
#pragma once

#include "base/vec.hpp"

namespace relumine {

struct WorldDir {
    Vec3 v;  // unit, world space
};
struct LocalDir {
    Vec3 v;  // unit, z along the normal of the frame it came from
};

constexpr WorldDir operator-(WorldDir w) { return {-w.v}; }
constexpr LocalDir operator-(LocalDir w) { return {-w.v}; }
constexpr float cos_theta(LocalDir w) { return w.v.z; }  // a WorldDir does not compile

struct Frame {     // right-handed, orthonormal
    Vec3 s, t, n;  // world space

    [[nodiscard]] LocalDir to_local(WorldDir w) const { return {{dot(w.v, s), dot(w.v, t), dot(w.v, n)}}; }
    [[nodiscard]] WorldDir to_world(LocalDir w) const { return {s * w.v.x + t * w.v.y + n * w.v.z}; }
};

/// The frame around a unit normal, without a branch on its direction [Duff17].
inline Frame frame_around(Vec3 n) {
    const float sign = std::copysign(1.0f, n.z);
    const float a = -1 / (sign + n.z);
    const float b = n.x * n.y * a;
    return {{1 + sign * n.x * n.x * a, sign * b, -sign * n.x}, {b, sign + n.y * n.y * a, -n.y}, n};
}

/// The frame around a unit normal whose s is closest to `direction`; that of frame_around where none is.
inline Frame frame_along(Vec3 n, Vec3 direction) {
    const Vec3 s = direction - n * dot(n, direction);
    const float length2 = dot(s, s);
    if (!(length2 > 1e-12f * dot(direction, direction))) return frame_around(n);
    const Vec3 unit_s = s / std::sqrt(length2);
    return {unit_s, cross(n, unit_s), n};
}

}  // namespace relumine
