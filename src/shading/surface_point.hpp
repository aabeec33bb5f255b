// SPDX-License-Identifier: Apache-2.0
// What is known where a ray has met a surface.
#pragma once

#include "base/frame.hpp"
#include "trace/tracer.hpp"

namespace relumine {

struct SurfacePoint {
    Vec3 position;          // world space
    Vec3 geometric_normal;  // unit, on the viewer's side
    Frame frame;            // shading frame; n on the viewer's side and turned so that the viewer is above it
    std::array<Vec2, 2> uv;  // texture coordinates, 0 where the mesh has none
    Spectrum vertex_color{1};
    bool has_vertex_color = false;
    const Material* material = nullptr;  // never null
    std::uint32_t instance = 0, triangle = 0;
    float offset = 0;   // metres along the geometric normal that clear the rounding errors of `position`
    bool front = true;  // the viewer is on the side from which the triangle is counter-clockwise
};

/// The surface at `hit`, seen along `w_out` (towards the viewer).
[[nodiscard]] SurfacePoint surface_point(const SceneData& scene, const Hit& hit, WorldDir w_out);

/// Texture coordinates and vertex alpha alone, for opacity tests during traversal.
struct TextureCoordinates {
    std::array<Vec2, 2> uv;
    float vertex_alpha = 1;
};
[[nodiscard]] TextureCoordinates texture_coordinates(const Mesh& mesh, const Hit& hit);

/// The corners of a triangle in world space, in the mesh's order.
[[nodiscard]] std::array<Vec3, 3> world_triangle(const SceneData& scene, std::uint32_t instance,
                                                 std::uint32_t triangle);

/// A bound on the rounding errors of points on a triangle with these corners, times a safety factor.
[[nodiscard]] float rounding_offset(const std::array<Vec3, 3>& corners);

/// The start of a ray that leaves the surface towards `direction`, on the side it leaves to.
inline Vec3 ray_origin(const SurfacePoint& p, WorldDir direction) {
    return p.position
           + p.geometric_normal * (dot(direction.v, p.geometric_normal) < 0 ? -p.offset : p.offset);
}

}  // namespace relumine
