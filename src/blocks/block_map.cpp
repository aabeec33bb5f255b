// SPDX-License-Identifier: Apache-2.0
// What block maps keep by tile.
#include "blocks/block_map.hpp"

#include <bit>

namespace relumine {
namespace {

void average(const std::vector<float>& texels, const std::vector<float>& share, std::vector<float>& means) {
    for (std::size_t tile = 0; tile < means.size(); ++tile) {
        float sum = 0;
        for (std::size_t i = 0; i < tile_texels; ++i) sum += texels[tile * tile_texels + i];
        means[tile] = sum * share[tile];
    }
}

}  // namespace

void RadiancePlanes::resize(const DirectionGrid& grid) {
    for (auto& plane : texels) plane.assign(grid.texels, 0);
    for (auto& plane : tile_means) plane.assign(grid.tiles, 0);
}

std::size_t BlockMap::bytes(const DirectionGrid& grid, bool reflects) {
    const std::size_t planes = reflects ? 6 : 3;
    const std::size_t floats = planes * (grid.texels + grid.tiles) + 2 * grid.tiles;
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
            average(planes->texels[c], share, planes->tile_means[c]);
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
