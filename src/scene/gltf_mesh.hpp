// SPDX-License-Identifier: Apache-2.0
// Meshes of a glTF file: each primitive becomes one Mesh.
#pragma once

#include <vector>

#include "scene/gltf_file.hpp"
#include "scene/scene_data.hpp"

namespace relumine {

/// How many more vertices and triangle corners may be read: a small file can name the same data many times.
struct GltfBudget {
    std::size_t elements = std::size_t{1} << 30;
};

/// The triangles of mesh `mesh`; points and lines are left out with a warning. A primitive without a material
/// gets `MaterialId{materials.size()}`. Vertex indices are not checked yet: finish_scene does that. Throws
/// SceneError.
[[nodiscard]] std::vector<Mesh> read_gltf_mesh(const GltfFile& file, int mesh, GltfBudget& budget,
                                               SceneData& scene);

}  // namespace relumine
