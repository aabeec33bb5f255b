// SPDX-License-Identifier: Apache-2.0
// Lights without extent.
#include "shading/delta_lights.hpp"

namespace relumine {
namespace {

/// Intensity spread over the sphere around `position`.
std::optional<LightSample> inverse_square(Vec3 position, Spectrum intensity, Vec3 from) {
    const Vec3 to_light = position - from;
    const float distance = length(to_light);
    if (!(distance > 0)) return {};
    return LightSample{{to_light / distance}, position, distance, intensity / sqr(distance), 1, true};
}

/// 1 inside the inner angle, 0 outside the outer one; between, KHR_lights_punctual's square of the cosine's
/// share, or pbrt's smooth step of it.
float cone(const SpotLight& light, Vec3 from) {
    const float cosine = dot(normalize(from - light.position), light.direction);
    const float ramp = (cosine - light.cos_outer) / std::max(1e-4f, light.cos_inner - light.cos_outer);
    const float t = std::clamp(ramp, 0.0f, 1.0f);
    return light.smoothstep ? t * t * (3 - 2 * t) : sqr(t);
}

}  // namespace

std::optional<LightSample> light_sample(const PointLight& light, Vec3 from) {
    return inverse_square(light.position, light.intensity, from);
}

std::optional<LightSample> light_sample(const SpotLight& light, Vec3 from) {
    const float share = cone(light, from);
    if (!(share > 0)) return {};
    return inverse_square(light.position, light.intensity * share, from);
}

std::optional<LightSample> light_sample(const DirectionalLight& light) {
    return LightSample{{-light.direction}, {}, infinity, light.irradiance, 1, true};
}

std::vector<LightSample> delta_light_samples(const SceneData& scene, Vec3 from) {
    std::vector<LightSample> samples;
    const auto keep = [&](const std::optional<LightSample>& sample) {
        if (sample) samples.push_back(*sample);
    };
    for (const PointLight& light : scene.point_lights) keep(light_sample(light, from));
    for (const SpotLight& light : scene.spot_lights) keep(light_sample(light, from));
    for (const DirectionalLight& light : scene.directional_lights) keep(light_sample(light));
    return samples;
}

}  // namespace relumine
