// SPDX-License-Identifier: Apache-2.0
// The inner loops of MapIntegral, for as many tiles or texels at once as the machine has lanes.
#pragma once

#include "blocks/blend.hpp"
#include "blocks/quadrature_points.hpp"

namespace relumine {

/// What decides a tile's tier.
struct TierQuery {
    Vec3 geometric_normal, shading_normal;
    Vec3 w_out;                      // world space
    float alpha = 0;                 // GGX; 0: no specular lobe
    bool exact = false;              // never one point
    float alpha_x = 0, alpha_y = 0;  // where they differ: α along the lobe's axes
    Vec3 axis_x, axis_y;             // those axes, world space
};

/// f·|cos θ| of a receiver, by channel.
struct BsdfPlanes {
    std::array<float*, 3> channel;
};

/// Over the maps of a blend, by tile: luminance's weighted mean and its variance within and between them, and
/// which texels all of them know.
struct BlendedTiles {
    std::span<float> luminance, variance;
    std::span<std::uint16_t> known;
};
void blend_tiles(const Blend& blend, const BlendedTiles& out);

/// What else decides, by tile: how much of f at its centre is the lobe's, [0, 1] (not read without a lobe),
/// and what a blend holds there.
struct TileContent {
    std::span<const float> lobe_share, luminance, variance;
    std::span<const std::uint16_t> known;
};
void choose_tiers(const DirectionGrid& grid, const TierQuery& query, const TileContent& content,
                  std::span<TileTier> tiers);

/// Sums over tiles or texels of f·|cos θ| times radiance, and of f·|cos θ| alone.
struct ReflectedSums {
    Spectrum direct, indirect, albedo;
};

/// Over the tiles of tier `one`, in each of which f is what it is at the centre and |cos θ|, against
/// `shading_normal`, follows its texels. f is 0 afterwards in all others.
[[nodiscard]] ReflectedSums sum_tiles(const DirectionGrid& grid, Vec3 shading_normal, const Blend& blend,
                                      std::span<const TileTier> tiers, const BsdfPlanes& bsdf);

/// What else is wanted of a tile's texels.
struct TexelSums {
    float bsdf = 0;     // Σ of the luminance of f·|cos θ|
    float unknown = 0;  // how many of them no map knows
};

/// Over the texels of the tiles in `tiles`; `bsdf` has tile_texels values for each. Where not all maps know a
/// texel, those that do share its weight; where none does, it is black.
[[nodiscard]] ReflectedSums sum_texels(const Blend& blend, std::span<const std::uint32_t> tiles,
                                       const BsdfPlanes& bsdf, std::span<TexelSums> by_tile);

/// Σ over the texels of `tiles` of how open to the environment they are, [0, 1], times `detail` (tile_texels
/// values for each tile).
[[nodiscard]] Spectrum sum_open(const Blend& blend, std::span<const std::uint32_t> tiles,
                                const BsdfPlanes& detail);

}  // namespace relumine
