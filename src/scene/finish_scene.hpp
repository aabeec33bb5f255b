// SPDX-License-Identifier: Apache-2.0
// From what a reader found to what the renderer can trust.
#pragma once

#include "scene/scene_data.hpp"

namespace relumine {

/// Validates everything (indices, finiteness, ranges), drops degenerate triangles (with a warning), moves
/// meshes that have one instance to world space, and computes bounds. Throws SceneError.
[[nodiscard]] SceneData finish_scene(SceneData scene);

/// Whether anything is there that may emit.
[[nodiscard]] bool emits_light(const SceneData& scene);

/// A camera that shows all of `bounds` from the front, above and a little from the right.
[[nodiscard]] Camera framing_camera(const Bounds3& bounds);

/// The mesh as a model on a neutral ground under a built-in sky, framed. Not finished yet. A mesh without
/// normals is given smooth ones with creases: see mesh_normals.hpp.
[[nodiscard]] SceneData stage_model(Mesh mesh);

/// A smooth sky with a soft sun over a dim ground, in W·sr⁻¹·m⁻².
[[nodiscard]] Environment builtin_sky();

}  // namespace relumine
