// SPDX-License-Identifier: Apache-2.0
// The sphere cut into texels of equal solid angle, in tiles of 4 × 4.
#pragma once

#include <cstdint>
#include <vector>

#include "base/packet.hpp"
#include "blocks/octahedral_map.hpp"

namespace relumine {

/// Texels of a tile; as many rays go together.
inline constexpr std::size_t tile_texels = packet_size;

/// Texels of the world's octahedral square in Morton order: bit 0 of an index is bit 0 of x, bit 1 bit 0 of
/// y and so on. So a tile's texels are one run, and so are the four quarters of any larger square.
struct DirectionGrid {
    /// `texels_along_side`: a power of two, 16 … 128.
    explicit DirectionGrid(int texels_along_side);

    int side;                                   // texels
    std::size_t texels, tiles;                  // counts
    float texel_solid_angle;                    // steradian
    std::vector<float> x, y, z;                 // unit directions through the texels' centres
    std::vector<float> tile_x, tile_y, tile_z;  // unit mean directions of the tiles
    std::vector<float> tile_length;             // of the mean direction before it was made unit
    std::vector<float> tile_sine;               // sine of the angle to a tile's farthest corner

    /// Texels to the right of each and below it; itself at the square's border.
    std::vector<std::uint32_t> right, below;

    [[nodiscard]] WorldDir texel_center(std::size_t texel) const { return {{x[texel], y[texel], z[texel]}}; }
    [[nodiscard]] WorldDir tile_center(std::size_t tile) const {
        return {{tile_x[tile], tile_y[tile], tile_z[tile]}};
    }
    /// The direction through a point of a texel, `inside` in [0, 1)².
    [[nodiscard]] WorldDir direction_in(std::uint32_t texel, Point2 inside) const;
    [[nodiscard]] std::uint32_t texel_at(WorldDir direction) const;
};

}  // namespace relumine
