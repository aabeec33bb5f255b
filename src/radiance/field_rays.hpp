// SPDX-License-Identifier: Apache-2.0
// Rays from the points of a radiance field's elements, and what arrives along them.
#pragma once

#include <span>
#include <vector>

#include "base/ray_counts.hpp"
#include "radiance/field_points.hpp"
#include "radiance/path.hpp"
#include "radiance/radiance_field.hpp"

namespace relumine {

/// The random numbers of a ray.
[[nodiscard]] SampleStream element_stream(std::uint64_t seed, ElementId element, std::uint32_t ray, int rays);

/// A light's direction turns the irradiance vector no farther than from this cosine.
inline constexpr float least_tilt_cosine = 0.2f;

/// Adds light from `direction` that gives `irradiance` on the surface of this normal.
void add_arriving(IrradianceVector& vector, Vec3 normal, Vec3 direction, Spectrum irradiance);

/// The rays of an element, all at once.
struct ElementRays {
    std::vector<SampleStream> streams;
    std::vector<Ray> rays;
    std::vector<Hit> hits;

    [[nodiscard]] std::size_t size() const { return rays.size(); }
};

/// The point that ray or sample i of `count` starts from: runs of a Sobol sequence are well spread, and each
/// point has one.
[[nodiscard]] inline std::size_t point_of(std::span<const StartPoint> points, int i, int count) {
    return static_cast<std::size_t>(i) * points.size() / static_cast<std::size_t>(count);
}

/// A direction in the frame of `normal` as it was in that of `from`: what it makes with the normal stays.
[[nodiscard]] Vec3 turned(Vec3 direction, Vec3 from, Vec3 normal);

/// Finds what the rays hit.
void trace(const Transport& t, ElementRays& all, RayCounts& counts);

/// Draws and traces `count` rays over the hemispheres of the points.
[[nodiscard]] ElementRays trace_rays(const Transport& t, std::span<const StartPoint> points, ElementId id,
                                     int count, std::uint64_t seed, RayCounts& counts);

}  // namespace relumine
