// SPDX-License-Identifier: Apache-2.0
// Tangents for normal maps of meshes that come without them.
#pragma once

#include <cstddef>

#include "scene/scene_data.hpp"

namespace relumine {

/// Gives the mesh tangents along u of the UV set; none where it has no such UVs. As in MikkTSpace they are
/// sums over the triangles around a vertex, but weighted by area and per vertex: vertices are not split where
/// a texture is mirrored.
void add_tangents(Mesh& mesh, std::size_t uv_set);

}  // namespace relumine
