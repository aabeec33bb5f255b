// SPDX-License-Identifier: Apache-2.0
// Groups of lights.
#include "shading/light_bounds.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace relumine {
namespace {

constexpr double double_pi = std::numbers::pi;
constexpr Cone every_direction{{0, 0, 1}, static_cast<float>(double_pi)};

/// cos(max(0, a − b)) of angles in [0, π].
float cos_of_difference(float sin_a, float cos_a, float sin_b, float cos_b) {
    return cos_a > cos_b ? 1 : cos_a * cos_b + sin_a * sin_b;
}
/// sin(max(0, a − b)).
float sin_of_difference(float sin_a, float cos_a, float sin_b, float cos_b) {
    return cos_a > cos_b ? 0 : sin_a * cos_b - cos_a * sin_b;
}

float sine(float cosine) { return std::sqrt(std::max(0.0f, 1 - sqr(cosine))); }

/// `v` turned about `axis` (unit, perpendicular to v). [Rodrigues]
Vec3 turned(Vec3 v, Vec3 axis, double angle) {
    return v * static_cast<float>(std::cos(angle)) + cross(axis, v) * static_cast<float>(std::sin(angle));
}

}  // namespace

Cone unite(const Cone& a, const Cone& b) {
    if (a.angle < 0) return b;
    if (b.angle < 0) return a;
    const double between = std::acos(std::clamp(double{dot(a.axis, b.axis)}, -1.0, 1.0));
    if (std::min(between + b.angle, double_pi) <= a.angle) return a;
    if (std::min(between + a.angle, double_pi) <= b.angle) return b;
    const double angle = (a.angle + between + b.angle) / 2;
    const Vec3 normal = cross(a.axis, b.axis);
    if (angle >= double_pi || length_squared(normal) == 0) return every_direction;
    return {normalize(turned(a.axis, normalize(normal), angle - a.angle)), static_cast<float>(angle)};
}

LightBounds unite(const LightBounds& a, const LightBounds& b) {
    if (a.intensity <= 0) return b;
    if (b.intensity <= 0) return a;
    LightBounds both = a;
    both.box.add(b.box.lower);
    both.box.add(b.box.upper);
    both.normals = unite(a.normals, b.normals);
    both.spread = std::max(a.spread, b.spread);
    both.intensity += b.intensity;
    both.two_sided = a.two_sided || b.two_sided;
    return both;
}

double orientation_cost(const LightBounds& bounds, double stretch) {
    const double o = bounds.normals.angle, w = std::min(o + bounds.spread, double_pi);
    const double directions =
        2 * double_pi * (1 - std::cos(o))
        + double_pi / 2 * (2 * w * std::sin(o) - std::cos(o - 2 * w) - 2 * o * std::sin(o) + std::cos(o));
    const double radius = bounds.box.radius();
    return bounds.intensity * directions * stretch * radius * radius;
}

LightCluster::LightCluster(const LightBounds& bounds)
    : center(bounds.box.center()),
      radius(bounds.box.radius()),
      axis(bounds.normals.axis),
      cos_normals(std::cos(bounds.normals.angle)),
      sin_normals(std::sin(bounds.normals.angle)),
      cos_spread(std::cos(bounds.spread)),
      intensity(bounds.intensity),
      two_sided(bounds.two_sided) {}

float importance(const LightCluster& c, Vec3 from) {
    const Vec3 way = from - c.center;
    const float distance2 = length_squared(way), radius2 = sqr(c.radius);
    if (!(distance2 > radius2)) return c.intensity / std::max(radius2, least_light_radius2);
    float cos_w = std::clamp(dot(c.axis, way) / std::sqrt(distance2), -1.0f, 1.0f);
    if (c.two_sided) cos_w = std::abs(cos_w);
    const float sin_w = sine(cos_w);
    const float cos_x = cos_of_difference(sin_w, cos_w, c.sin_normals, c.cos_normals);
    const float sin_x = sin_of_difference(sin_w, cos_w, c.sin_normals, c.cos_normals);
    const float sin2_b = radius2 / distance2, cos_b = std::sqrt(1 - sin2_b);
    const float cosine = cos_of_difference(sin_x, cos_x, std::sqrt(sin2_b), cos_b);
    if (cosine < c.cos_spread - light_rim) return 0;
    return c.intensity * std::max(cosine, light_rim) / distance2;
}

}  // namespace relumine
