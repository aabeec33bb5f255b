// SPDX-License-Identifier: Apache-2.0
// The a-priori error of sharing a map.
#include "blocks/parallax.hpp"

namespace relumine {
namespace {

float radiance_at(const BlockMap& map, std::size_t texel) {
    return luminance(map.direct.at(texel)) + (map.indirect.empty() ? 0 : luminance(map.indirect.at(texel)));
}

/// The mean of what is farther away than `displacement`; of all where nothing is.
float radiance_beyond(const DirectionGrid& grid, const BlockMap& map, std::span<const float> distances,
                      std::span<const float> weights, float displacement) {
    double far = 0, far_weight = 0, all = 0, all_weight = 0;
    for (std::size_t tile = 0; tile < grid.tiles; ++tile) {
        if (map.known[tile] == 0 || weights[tile] <= 0) continue;
        for (std::size_t texel = tile * tile_texels; texel < (tile + 1) * tile_texels; ++texel) {
            const double reflected = double{weights[tile]} * radiance_at(map, texel);
            all += reflected;
            all_weight += weights[tile];
            if (distances[texel] < displacement) continue;
            far += reflected;
            far_weight += weights[tile];
        }
    }
    if (far_weight > 0) return static_cast<float>(far / far_weight);
    return static_cast<float>(all_weight > 0 ? all / all_weight : 0);
}

}  // namespace

float parallax_error(const DirectionGrid& grid, const BlockMap& map, std::span<const float> distances,
                     std::span<const float> weights, float displacement, float level) {
    const float side = std::sqrt(grid.texel_solid_angle);
    const float beyond = radiance_beyond(grid, map, distances, weights, displacement);
    double swept = 0, reflected = 0, albedo = 0;
    for (std::size_t tile = 0; tile < grid.tiles; ++tile) {
        if (map.known[tile] == 0 || weights[tile] <= 0) continue;
        reflected += double{weights[tile]} * map.tile_luminance[tile];
        albedo += weights[tile];
        double edges = 0;
        for (std::size_t texel = tile * tile_texels; texel < (tile + 1) * tile_texels; ++texel) {
            const float here = radiance_at(map, texel);
            for (const std::uint32_t other : {grid.right[texel], grid.below[texel]}) {
                const float nearer = std::min(distances[texel], distances[other]);
                if (!std::isfinite(nearer)) continue;
                edges += std::abs(here - radiance_at(map, other)) * std::min(side, displacement / nearer);
            }
            if (distances[texel] < displacement)
                edges += std::abs(here - beyond) * side * (1 - distances[texel] / displacement);
        }
        swept += weights[tile] * edges;
    }
    const double whole = std::max(reflected, level * albedo) * tile_texels * side;
    return whole > 0 ? static_cast<float>(swept / whole) : 0;
}

}  // namespace relumine
