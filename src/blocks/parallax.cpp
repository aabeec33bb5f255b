// SPDX-License-Identifier: Apache-2.0
// The a-priori error of sharing a map.
#include "blocks/parallax.hpp"

namespace relumine {

float parallax_error(const DirectionGrid& grid, const BlockMap& map, std::span<const float> distances,
                     std::span<const float> weights, float displacement, float level) {
    const float side = std::sqrt(grid.texel_solid_angle);
    const auto radiance = [&](std::size_t texel) {
        return luminance(map.direct.at(texel))
               + (map.indirect.empty() ? 0 : luminance(map.indirect.at(texel)));
    };
    double swept = 0, reflected = 0, albedo = 0;
    for (std::size_t tile = 0; tile < grid.tiles; ++tile) {
        if (map.known[tile] == 0 || weights[tile] <= 0) continue;
        reflected += double{weights[tile]} * map.tile_luminance[tile];
        albedo += weights[tile];
        double edges = 0;
        for (std::size_t texel = tile * tile_texels; texel < (tile + 1) * tile_texels; ++texel)
            for (const std::uint32_t other : {grid.right[texel], grid.below[texel]}) {
                const float nearer = std::min(distances[texel], distances[other]);
                if (!std::isfinite(nearer)) continue;
                edges += std::abs(radiance(texel) - radiance(other)) * std::min(side, displacement / nearer);
            }
        swept += weights[tile] * edges;
    }
    const double whole = std::max(reflected, level * albedo) * tile_texels * side;
    return whole > 0 ? static_cast<float>(swept / whole) : 0;
}

}  // namespace relumine
