// SPDX-License-Identifier: Apache-2.0
// Lobes given by two roughnesses, along u and along v, in the terms of KHR_materials_anisotropy.
#pragma once

#include <algorithm>
#include <cmath>

#include "scene/scene_data.hpp"

namespace relumine {

/// α is roughness² along one direction and lerp(roughness², 1, anisotropy²) along the other.
struct LobeAlong {
    float roughness = 0, anisotropy = 0;
    bool along_v = false;  // where it is rougher; else along u
};

/// GGX α in [0, 1]; below 1e-3 it is that of a mirror.
inline LobeAlong lobe_along(float alpha_u, float alpha_v) {
    const auto tame = [](float alpha) { return alpha < 1e-3f ? 0.0f : std::min(alpha, 1.0f); };
    const float u = tame(alpha_u), v = tame(alpha_v), low = std::min(u, v), high = std::max(u, v);
    return {std::sqrt(low), high > low ? std::sqrt((high - low) / (1 - low)) : 0.0f, v > u};
}

/// The same as a texel of an anisotropy texture.
inline Vec4 anisotropy_texel(const LobeAlong& lobe) {
    return lobe.along_v ? Vec4{0.5f, 1, lobe.anisotropy, 1} : Vec4{1, 0.5f, lobe.anisotropy, 1};
}

/// Gives the material the lobe's orientation, baked into a texture or as such a texel.
inline void set_anisotropy(const std::optional<TextureRef>& texture, Vec4 texel, Material& material) {
    material.anisotropy_texture = texture;
    material.anisotropy = texture ? 1.0f : texel.z;
    material.anisotropy_rotation = texture || texel.x == 1 ? 0.0f : pi / 2;
}

}  // namespace relumine
