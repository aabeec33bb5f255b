// SPDX-License-Identifier: Apache-2.0
// pbrt's light sources: points, spots, distant ones and those from infinity.
#pragma once

#include "scene/pbrt_textures.hpp"

namespace relumine {

/// Adds all LightSource entities; several that come from infinity are summed into one environment.
void add_pbrt_lights(PbrtScene& scene, PbrtFiles& files, SceneData& out);

/// Multiplies all light of the scene.
void scale_lights(SceneData& scene, float factor);

}  // namespace relumine
