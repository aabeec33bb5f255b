// SPDX-License-Identifier: Apache-2.0
// EXT_mesh_gpu_instancing: one node, many places.
#pragma once

#include <optional>

#include "scene/gltf_nodes.hpp"

namespace relumine {

/// The places of the node's mesh, in the node's space; empty where the node has no such extension. What is
/// neither TRANSLATION, ROTATION nor SCALE is ignored. Each place takes `parts` of the budget. Throws
/// SceneError.
[[nodiscard]] std::optional<std::vector<Transform>> read_gltf_instancing(const GltfFile& file, int node,
                                                                         std::size_t parts,
                                                                         std::size_t& budget);

/// Places in all of a file, of parts of meshes.
inline constexpr std::size_t max_gltf_places = std::size_t{1} << 23;

}  // namespace relumine
