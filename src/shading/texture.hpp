// SPDX-License-Identifier: Apache-2.0
// Reading textures: wrapping, bilinear interpolation, sRGB decoding.
#pragma once

#include <array>

#include "scene/scene_data.hpp"

namespace relumine {

enum class Encoding { linear, srgb };  // of RGB; alpha is always linear

/// What a point of a surface reads textures by.
struct TextureUv {
    std::array<Vec2, 2> sets{};  // 0 where the mesh has none
    float facing = 0;            // |cosine| of its normal and the mesh's TextureProjection::axis
};

/// The texture's value at a surface's coordinates, RGBA in [0, 1]; RGB decoded to linear before
/// interpolation.
[[nodiscard]] Vec4 sample_texture(const SceneData& scene, const TextureRef& texture, const TextureUv& uv,
                                  Encoding encoding);

}  // namespace relumine
