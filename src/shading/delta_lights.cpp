// SPDX-License-Identifier: Apache-2.0
// Lights without extent.
#include "shading/delta_lights.hpp"

#include "base/equal_area.hpp"

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

/// The factor of the pattern's texel that light towards the world's direction `w` passes.
Spectrum pattern_factor(const LightPattern& pattern, Vec3 w) {
    const auto& m = pattern.light_from_world.m;
    std::array<double, 3> d{};
    for (std::size_t i = 0; i < 3; ++i)
        d[i] = m[i][0] * double{w.x} + m[i][1] * double{w.y} + m[i][2] * double{w.z};
    const double length = std::hypot(d[0], d[1], d[2]);
    for (double& x : d) x /= length;
    Vec2 at;
    if (pattern.equal_area) {
        at = equal_area_square(d);
    } else {
        if (d[2] < 1e-3) return {};
        const double x = d[0] / d[2] / pattern.half_width, y = d[1] / d[2] / pattern.half_height;
        if (!(std::abs(x) <= 1 && std::abs(y) <= 1)) return {};
        at = {static_cast<float>((1 + x) / 2), static_cast<float>((1 - y) / 2)};
    }
    const auto texel = [](float x, int size) {
        return static_cast<std::size_t>(
            std::clamp(static_cast<int>(x * static_cast<float>(size)), 0, size - 1));
    };
    return pattern.factor[texel(at.y, pattern.height) * static_cast<std::size_t>(pattern.width)
                          + texel(at.x, pattern.width)];
}

}  // namespace

std::optional<LightSample> light_sample(const PointLight& light, Vec3 from) {
    if (!light.pattern) return inverse_square(light.position, light.intensity, from);
    const Spectrum factor = pattern_factor(*light.pattern, from - light.position);
    if (is_black(factor)) return {};
    return inverse_square(light.position, light.intensity * factor, from);
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
