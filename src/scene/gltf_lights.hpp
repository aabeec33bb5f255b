// SPDX-License-Identifier: Apache-2.0
// Lights and cameras of a glTF file.
#pragma once

#include <string>

#include "scene/gltf_nodes.hpp"
#include "scene/scene_data.hpp"

namespace relumine {

/// Adds the node's KHR_lights_punctual light, if it has one. Throws SceneError.
void add_gltf_light(const GltfFile& file, const PlacedNode& placed, SceneData& scene);

/// Adds the node's camera, if it has one, under a name that no other camera has. Throws SceneError.
void add_gltf_camera(const GltfFile& file, const PlacedNode& placed, SceneData& scene);

}  // namespace relumine
