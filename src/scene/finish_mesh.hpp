// SPDX-License-Identifier: Apache-2.0
// Meshes made trustworthy: checked, cleaned of what has no area, complete, and moved to world space.
#pragma once

#include "scene/scene_data.hpp"

namespace relumine {

/// Checks sizes, indices and finiteness (SceneError); drops degenerate triangles and unused vertices; repairs
/// normals, tangents, UVs and colours; adds tangents where a normal map needs them. Warns of what it dropped
/// or repaired.
void finish_meshes(SceneData& scene);

/// Applies the transform to positions, normals and tangents, keeps the outward side of every triangle, and
/// leaves the spare bytes behind the last vertex that Embree reads.
void move_to_world(Mesh& mesh, const Transform& world_from_object);

}  // namespace relumine
