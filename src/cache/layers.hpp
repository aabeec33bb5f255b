// SPDX-License-Identifier: Apache-2.0
// Sorting what a record has hit into depth layers on a logarithmic scale [V, §3.2].
#pragma once

#include <cstdint>
#include <vector>

#include "cache/hemisphere_samples.hpp"

namespace relumine {

struct DepthLayers {
    std::vector<std::uint8_t> layer_of_texel;  // `count` for misses, which lie behind all
    int count = 0;                             // layers of hits, K
    float nearest = infinity, farthest = 0;    // metres
};

/// `count` in [1, 64].
[[nodiscard]] DepthLayers sort_into_layers(const std::vector<TexelSample>& texels, int count);

}  // namespace relumine
