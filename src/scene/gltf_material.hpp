// SPDX-License-Identifier: Apache-2.0
// Materials, textures and images of a glTF file.
#pragma once

#include "scene/gltf_file.hpp"
#include "scene/scene_data.hpp"

namespace relumine {

/// Fills `scene.materials`, in file order, and `scene.images` with the images that they use, decoded on all
/// threads. Throws SceneError or ImageError.
void read_gltf_materials(const GltfFile& file, std::uint64_t texture_limit, SceneData& scene);

}  // namespace relumine
