// SPDX-License-Identifier: Apache-2.0
// The node hierarchy of a glTF file, flattened: which nodes are in the scene and where.
#pragma once

#include <array>
#include <vector>

#include "base/transform.hpp"
#include "scene/gltf_file.hpp"

namespace relumine {

struct PlacedNode {
    int node = 0;  // index in the file
    Transform world_from_node;
};

/// The nodes of the default scene, parents first, children in file order; of the first scene where there is
/// no default, and all nodes of a file without scenes. Throws SceneError for cycles, for two parents and for
/// invalid transforms.
[[nodiscard]] std::vector<PlacedNode> place_nodes(const GltfFile& file);

/// From translation t, unit quaternion q = (x, y, z, w) and scale s: T · R · S.
[[nodiscard]] Transform from_trs(const std::array<double, 3>& t, const std::array<double, 4>& q,
                                 const std::array<double, 3>& s);

}  // namespace relumine
