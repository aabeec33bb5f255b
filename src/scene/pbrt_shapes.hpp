// SPDX-License-Identifier: Apache-2.0
// pbrt's shapes as triangle meshes.
#pragma once

#include "scene/pbrt_files.hpp"
#include "scene/pbrt_scene.hpp"
#include "scene/scene_data.hpp"

namespace relumine {

/// How finely curved shapes are cut.
struct PbrtDetail {
    int circle = 256;  // straight pieces of a full circle
    int patch = 32;    // pieces along each side of a bilinear patch that is not flat
};

/// The shape in object space. Triangles are counter-clockwise seen from the side that pbrt calls outside (its
/// normals, ReverseOrientation included); v of the texture coordinates is flipped to grow downwards. Empty
/// for kinds that are left out, with a warning. Throws SceneError with the shape's place. `needs_uv`: where
/// the file gives no texture coordinates, add pbrt's own.
[[nodiscard]] Mesh make_pbrt_mesh(const PbrtShape& shape, const PbrtDetail& detail, bool needs_uv,
                                  PbrtFiles& files, PbrtScene& scene);

/// Whether shapes of that kind with equal parameters are best made once and placed often.
[[nodiscard]] bool is_pbrt_quadric(const std::string& type);

[[nodiscard]] Mesh pbrt_sphere(const PbrtParameters& p, const PbrtDetail& detail);
[[nodiscard]] Mesh pbrt_disk(const PbrtParameters& p, const PbrtDetail& detail);
[[nodiscard]] Mesh pbrt_cylinder(const PbrtParameters& p, const PbrtDetail& detail);
[[nodiscard]] Mesh pbrt_bilinear_mesh(const PbrtParameters& p, const PbrtDetail& detail);
[[nodiscard]] Mesh pbrt_loop_subdivision(const PbrtParameters& p);

/// "indices" of a mesh shape, `corners` per face, each below `vertices`.
[[nodiscard]] std::vector<std::uint32_t> pbrt_indices(const PbrtParameters& p, std::size_t corners,
                                                      std::size_t vertices);

}  // namespace relumine
