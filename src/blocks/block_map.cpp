// SPDX-License-Identifier: Apache-2.0
// What block maps keep by tile.
#include "blocks/block_map.hpp"

#include <bit>

namespace relumine {
namespace {

/// `share`: by tile, one over the number of known texels.
void average_moments(const DirectionGrid& grid, const std::vector<float>& texels,
                     const std::vector<float>& share, std::array<std::vector<float>, 3>& moments) {
    for (std::size_t tile = 0; tile < grid.tiles; ++tile) {
        float x = 0, y = 0, z = 0;
        for (std::size_t i = tile * tile_texels; i < (tile + 1) * tile_texels; ++i) {
            x += texels[i] * grid.x[i];
            y += texels[i] * grid.y[i];
            z += texels[i] * grid.z[i];
        }
        moments[0][tile] = x * share[tile];
        moments[1][tile] = y * share[tile];
        moments[2][tile] = z * share[tile];
    }
}

}  // namespace

void RadiancePlanes::resize(const DirectionGrid& grid) {
    for (auto& plane : texels) plane.assign(grid.texels, 0);
    for (auto& axes : tile_moments)
        for (auto& plane : axes) plane.assign(grid.tiles, 0);
}

std::size_t BlockMap::bytes(const DirectionGrid& grid, bool reflects) {
    const std::size_t planes = reflects ? 6 : 3, moments = 3 * planes;
    const std::size_t floats = planes * grid.texels + (moments + 2) * grid.tiles;
    return sizeof(BlockMap) + sizeof(float) * floats + sizeof(std::uint16_t) * 2 * grid.tiles;
}

void BlockMap::resize(const DirectionGrid& grid, bool reflects) {
    direct.resize(grid);
    if (reflects) indirect.resize(grid);
    known.assign(grid.tiles, 0);
    open.assign(grid.tiles, 0);
}

void BlockMap::finish(const DirectionGrid& grid) {
    std::vector<float> share(grid.tiles);
    for (std::size_t tile = 0; tile < grid.tiles; ++tile)
        share[tile] = known[tile] ? 1 / static_cast<float>(std::popcount(known[tile])) : 0;
    for (RadiancePlanes* planes : {&direct, &indirect})
        for (std::size_t c = 0; c < 3 && !planes->empty(); ++c)
            average_moments(grid, planes->texels[c], share, planes->tile_moments[c]);
    tile_luminance.assign(grid.tiles, 0);
    tile_variance.assign(grid.tiles, 0);
    for (std::size_t tile = 0; tile < grid.tiles; ++tile) {
        float sum = 0, squares = 0;
        for (std::size_t i = 0; i < tile_texels; ++i) {
            const std::size_t t = tile * tile_texels + i;
            float l = luminance(direct.at(t));
            if (!indirect.empty()) l += luminance(indirect.at(t));
            sum += l;
            squares += l * l;
        }
        tile_luminance[tile] = sum * share[tile];
        tile_variance[tile] = std::max(0.0f, (squares - sum * sum * share[tile]) * share[tile]);
    }
}

}  // namespace relumine
