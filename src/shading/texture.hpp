// SPDX-License-Identifier: Apache-2.0
// Reading textures: wrapping, bilinear interpolation, sRGB decoding.
#pragma once

#include <array>

#include "scene/scene_data.hpp"

namespace relumine {

enum class Encoding { linear, srgb };  // of RGB; alpha is always linear

/// The texture's value at a surface's coordinates, RGBA in [0, 1]; RGB decoded to linear before
/// interpolation.
[[nodiscard]] Vec4 sample_texture(const SceneData& scene, const TextureRef& texture,
                                  const std::array<Vec2, 2>& uv, Encoding encoding);

}  // namespace relumine
