// SPDX-License-Identifier: Apache-2.0
// A block map: the incident radiance that a group of neighbouring camera samples shares.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "blocks/direction_grid.hpp"
#include "cache/hemisphere_samples.hpp"

namespace relumine {

/// The axes of all maps are the world's.
inline constexpr Frame map_frame{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};

/// Radiance by texel of the world's grid, one plane per channel; what is bright is not in it.
struct RadiancePlanes {
    std::array<std::vector<float>, 3> texels;  // W·sr⁻¹·m⁻²; 0 where unknown
    /// By channel and axis: the mean over a tile's known texels of radiance times direction. What a matte
    /// surface reflects is the product with its normal, however radiance and cosine vary within the tile.
    std::array<std::array<std::vector<float>, 3>, 3> tile_moments;

    [[nodiscard]] bool empty() const { return texels[0].empty(); }
    void resize(const DirectionGrid& grid);
    [[nodiscard]] Spectrum at(std::size_t texel) const {
        return {texels[0][texel], texels[1][texel], texels[2][texel]};
    }
    void put(std::size_t texel, Spectrum radiance) {
        texels[0][texel] = radiance.r;
        texels[1][texel] = radiance.g;
        texels[2][texel] = radiance.b;
    }
};

inline constexpr std::uint16_t whole_tile = 0xffff;

struct BlockMap {
    GatherPoint anchor;                // where most rays start
    float footprint = 0;               // metres that a pixel covers there
    float center_x = 0, center_y = 0;  // pixels: the block's middle
    float size = 0;                    // pixels: the block's side; the map reaches so far from its middle
    RadiancePlanes direct;             // from lights
    RadiancePlanes indirect;           // reflected by what is seen; empty where the source reflects nothing
    std::vector<std::uint16_t> known;  // per tile, a bit per texel: some sample of the group sees it
    std::vector<std::uint16_t> open;   // the same: nothing but the environment is seen
    std::vector<float> tile_luminance, tile_variance;  // mean and variance of luminance within each tile

    /// Memory that a finished map occupies.
    [[nodiscard]] static std::size_t bytes(const DirectionGrid& grid, bool reflects);

    /// Knows nothing afterwards.
    void resize(const DirectionGrid& grid, bool reflects);

    /// Derives what is kept by tile.
    void finish(const DirectionGrid& grid);
};

}  // namespace relumine
