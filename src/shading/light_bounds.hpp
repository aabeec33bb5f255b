// SPDX-License-Identifier: Apache-2.0
// Where a group of lights is, where it shines and how strongly: what a light tree chooses by [Conty18].
#pragma once

#include "base/vec.hpp"

namespace relumine {

/// All directions within an angle of an axis.
struct Cone {
    Vec3 axis{0, 0, 1};  // unit
    float angle = -1;    // radians, [0, π]; < 0: no direction
};
[[nodiscard]] Cone unite(const Cone& a, const Cone& b);

struct LightBounds {
    Bounds3 box;          // of the lights' points
    Cone normals;         // of the lights' axes
    float spread = 0;     // radians about each axis that it shines into: π/2 of a surface, up to π in all
    float intensity = 0;  // the sum along the axes, W·sr⁻¹, mean of the channels
    bool two_sided = false;  // some shine along the opposite axes as well
};
[[nodiscard]] LightBounds unite(const LightBounds& a, const LightBounds& b);

/// The surface area orientation heuristic: how much light goes how many ways [Conty18, eq. 1], up to a
/// factor, with the area of the box's sphere, which is what importance() sees. `stretch`: the longest side of
/// what is split over the side that it is split along.
[[nodiscard]] double orientation_cost(const LightBounds& bounds, double stretch);

/// A group as seen from points: a sphere instead of the box, angles as cosines.
struct LightCluster {
    Vec3 center;
    float radius = 0;
    Vec3 axis;
    float cos_normals = 1, sin_normals = 0;  // of the cone's angle
    float cos_spread = 0;
    float intensity = 0;
    bool two_sided = false;

    LightCluster() = default;
    explicit LightCluster(const LightBounds& bounds);
};

/// A cosine: so that rounding cannot hide a light at the rim of a bound.
inline constexpr float light_rim = 1e-3f;
/// metres², so that a point on a point light divides by something.
inline constexpr float least_light_radius2 = 1e-20f;

/// About how much of the group's light arrives at `from`, and never 0 where any may; W·m⁻² up to a factor.
[[nodiscard]] float importance(const LightCluster& cluster, Vec3 from);

}  // namespace relumine
