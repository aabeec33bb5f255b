// SPDX-License-Identifier: Apache-2.0
// What is known where a ray has met a surface.
#pragma once

#include "base/frame.hpp"
#include "shading/texture.hpp"
#include "trace/tracer.hpp"

namespace relumine {

struct SurfacePoint {
    Vec3 position;          // world space
    Vec3 geometric_normal;  // unit, on the viewer's side
    // Shading frame: n on the viewer's side and turned so that the viewer is above it, s where the lobes of
    // anisotropic materials are rougher.
    Frame frame;
    TextureUv uv;
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
    TextureUv uv;
    float vertex_alpha = 1;
};
[[nodiscard]] TextureCoordinates texture_coordinates(const SceneData& scene, const Hit& hit);

/// The corners of a triangle in world space, in the mesh's order.
[[nodiscard]] std::array<Vec3, 3> world_triangle(const SceneData& scene, std::uint32_t instance,
                                                 std::uint32_t triangle);

/// What shading needs to know of a triangle without a normal map.
struct ShadingTriangle {
    std::array<Vec3, 3> corners;  // world space, in the mesh's order
    Vec3 normal;                  // the vertices' normals at the hit, of any length; 0: flat shading
    Vec3 lobe_axis;               // along which anisotropic lobes are rougher; 0: they are not
    float winding = 1;            // −1 where the transform to world space mirrors, so reverses that order
};
[[nodiscard]] ShadingTriangle shading_triangle(const SceneData& scene, const Hit& hit);

/// The least cosine between viewer and shading normal; a smaller one would leave the viewer under the
/// surface.
inline constexpr float min_view_cosine = 1e-3f;

/// Of the largest coordinate: a bound on rounding errors of points on a triangle, times a safety factor.
inline constexpr float rounding_units = 32 * 0x1p-24f;

/// A bound on the rounding errors of points on a triangle with these corners, times a safety factor.
[[nodiscard]] float rounding_offset(const std::array<Vec3, 3>& corners);

/// The start of a ray that leaves the surface towards `direction`, on the side it leaves to.
inline Vec3 ray_origin(const SurfacePoint& p, WorldDir direction) {
    return p.position
           + p.geometric_normal * (dot(direction.v, p.geometric_normal) < 0 ? -p.offset : p.offset);
}

}  // namespace relumine
