// SPDX-License-Identifier: Apache-2.0
// The points of the grid's texels at which BSDFs are evaluated, finer where they are sharper.
#pragma once

#include <array>

#include "blocks/direction_grid.hpp"
#include "cache/receiver_bsdf.hpp"

namespace relumine {

/// By how many points f·|cos θ| is taken in a tile: one, or 1, 4 or 16 for each of its texels.
enum class TileTier : std::uint8_t { below, one, texels, quarters, sixteenths };

inline constexpr std::array<TileTier, 3> fine_tiers{TileTier::texels, TileTier::quarters,
                                                    TileTier::sixteenths};

/// Points per texel of a fine tier.
constexpr std::size_t points_per_texel(std::size_t fine_tier) { return std::size_t{1} << 2 * fine_tier; }

/// The directions of all points of the fine tiers, in runs by tile.
struct QuadraturePoints {
    explicit QuadraturePoints(const DirectionGrid& grid);

    std::array<DirectionRuns, fine_tiers.size()> tiers;
};

/// Where in its tier's runs point `point`, counted in the Morton order of the finer grid, stands.
constexpr std::size_t run_position(std::size_t point, std::size_t per_texel) {
    const std::size_t texel = point / per_texel, tile = texel / tile_texels;
    return (tile * per_texel + point % per_texel) * tile_texels + texel % tile_texels;
}

}  // namespace relumine
