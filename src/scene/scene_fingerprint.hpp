// SPDX-License-Identifier: Apache-2.0
// Hashes of the parts of a scene, to tell whether a picture begun before is still of the same one.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "scene/scene_data.hpp"

namespace relumine {

/// Name and hash of each part: geometry, instances, materials, textures, lights, environment, cameras. Every
/// byte that a picture can depend on counts; where the scene came from does not.
[[nodiscard]] std::vector<std::pair<std::string, std::uint64_t>> scene_fingerprint(const SceneData& scene);

}  // namespace relumine
