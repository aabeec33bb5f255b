// SPDX-License-Identifier: Apache-2.0
// How wrong a map is for a point beside the one that it was traced from.
#pragma once

#include "blocks/block_map.hpp"

namespace relumine {

/// The error of what is reflected, relative to it, where a map is used at `displacement` metres from its
/// anchor: every edge in it, of length s (a texel's side) and distance r, sweeps s · min(s, displacement / r)
/// steradian, and what is nearer than the displacement may give way to the mean of what is not. `distances`:
/// by texel, metres. `weights`: f·|cos θ| by tile, in any unit; what is reflected counts as at least what
/// radiance `level` everywhere would give.
[[nodiscard]] float parallax_error(const DirectionGrid& grid, const BlockMap& map,
                                   std::span<const float> distances, std::span<const float> weights,
                                   float displacement, float level);

}  // namespace relumine
