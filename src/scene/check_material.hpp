// SPDX-License-Identifier: Apache-2.0
// Ranges of material values.
#pragma once

#include "scene/scene_data.hpp"

namespace relumine {

/// Throws SceneError for values outside of their ranges and for textures that do not exist; sets values that
/// are out by no more than rounding to the range's end.
void check_materials(SceneData& scene);

/// Finite and nowhere negative.
[[nodiscard]] bool is_radiance(Spectrum s);

}  // namespace relumine
