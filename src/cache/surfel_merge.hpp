// SPDX-License-Identifier: Apache-2.0
// Merging neighbouring texels of a layer that lie on one plane into rectangular surfels [V, §3.2].
#pragma once

#include "cache/layers.hpp"
#include "cache/record.hpp"

namespace relumine {

/// When neighbours may become one surfel.
struct MergeLimits {
    int side = max_surfel_side;  // texels, at most max_surfel_side
    float cos_normals = 0.8f;    // least cosine between normals
    float reuse_distance = 0;    // metres: the longest way at which the record will be used, d_max
};

/// Covers all texels with rectangles of at most side × side texels, each within one layer and, but for those
/// at infinity, on one plane: a hit may stand off it by s·r²/(4·d_max), which moves its projection by a
/// quarter of a texel at the longest reuse (s: angular size of a texel, r: distance).
[[nodiscard]] Surfels merge_surfels(const std::vector<TexelSample>& texels, const DepthLayers& layers,
                                    const GatherPoint& point, int side, const MergeLimits& limits);

}  // namespace relumine
