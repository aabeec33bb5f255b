// SPDX-License-Identifier: Apache-2.0
// Mitsuba's emitters that are no shapes.
#pragma once

#include "scene/mitsuba_textures.hpp"

namespace relumine {

/// Adds lights and the environment. Throws SceneError or ImageError.
void add_mitsuba_emitters(MitsubaScene& scene, const std::vector<const MitsubaElement*>& emitters,
                          SceneData& out);

}  // namespace relumine
