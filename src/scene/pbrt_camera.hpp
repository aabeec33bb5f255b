// SPDX-License-Identifier: Apache-2.0
// pbrt's cameras and films.
#pragma once

#include "scene/pbrt_scene.hpp"
#include "scene/scene_data.hpp"

namespace relumine {

/// The camera with the film's size and crop.
[[nodiscard]] Camera make_pbrt_camera(PbrtScene& scene);

/// What pbrt's film multiplies radiance with: exposure time × ISO / 100.
[[nodiscard]] double pbrt_imaging_ratio(PbrtScene& scene);

}  // namespace relumine
