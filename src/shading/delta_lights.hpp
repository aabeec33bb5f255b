// SPDX-License-Identifier: Apache-2.0
// Lights without extent: what arrives from each at a point.
#pragma once

#include "shading/light_sampler.hpp"

namespace relumine {

/// Empty where the light does not shine on `from`. `pdf` is 1.
[[nodiscard]] std::optional<LightSample> light_sample(const PointLight& light, Vec3 from);
[[nodiscard]] std::optional<LightSample> light_sample(const SpotLight& light, Vec3 from);
[[nodiscard]] std::optional<LightSample> light_sample(const DirectionalLight& light);

}  // namespace relumine
