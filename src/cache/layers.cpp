// SPDX-License-Identifier: Apache-2.0
// Depth layers.
#include "cache/layers.hpp"

namespace relumine {

DepthLayers sort_into_layers(const std::vector<TexelSample>& texels, int count) {
    DepthLayers layers{std::vector<std::uint8_t>(texels.size(), static_cast<std::uint8_t>(count)), count};
    for (const TexelSample& texel : texels) {
        if (texel.distance == infinity) continue;
        layers.nearest = std::min(layers.nearest, texel.distance);
        layers.farthest = std::max(layers.farthest, texel.distance);
    }
    const float range = std::log(layers.farthest / layers.nearest);
    const float layers_per_log = range > 1e-6f ? static_cast<float>(count) / range : 0;
    for (std::size_t i = 0; i < texels.size(); ++i) {
        if (texels[i].distance == infinity) continue;
        const auto layer = static_cast<int>(layers_per_log * std::log(texels[i].distance / layers.nearest));
        layers.layer_of_texel[i] = static_cast<std::uint8_t>(std::clamp(layer, 0, count - 1));
    }
    return layers;
}

}  // namespace relumine
