// SPDX-License-Identifier: Apache-2.0
// Mitsuba's sensors and films as cameras.
#pragma once

#include "scene/mitsuba_properties.hpp"
#include "scene/scene_data.hpp"

namespace relumine {

/// Throws SceneError. Warns of what samplers and films ask for and the command decides.
[[nodiscard]] Camera make_mitsuba_camera(MitsubaScene& scene, const MitsubaElement& sensor);

}  // namespace relumine
