// SPDX-License-Identifier: Apache-2.0
// What a receiver reflects of the radiance in its maps: Σ L·f·|cos θ|·dω, tile by tile.
#pragma once

#include "blocks/dim_environment.hpp"
#include "blocks/map_kernel.hpp"
#include "cache/receiver_bsdf.hpp"

namespace relumine {

/// Radiance by the number of scattering vertices before it.
struct MapRadiance {
    Spectrum direct, indirect;
};

/// The integral over the maps that a receiver blends, and the piecewise constant integrand behind it, in four
/// tiers of quadrature: 1, 16, 64 or 256 points per tile. Holds what it needs to run again for another
/// receiver without allocating.
class MapIntegral {
  public:
    /// Texels with a free view count with all the detail of `environment` that sharp lobes resolve.
    /// `exact`: f·|cos θ| is taken at every texel, so that bsdf_at and radiance_at describe the integrand to
    /// the last texel.
    MapIntegral(const DirectionGrid& grid, const QuadraturePoints& points, const DimEnvironment& environment,
                bool exact);

    /// `bsdf` in world space; `geometric_normal` on the viewer's side.
    void run(const Blend& blend, const ReceiverBsdf& bsdf, Vec3 geometric_normal);

    /// What is reflected.
    [[nodiscard]] MapRadiance reflected() const { return reflected_; }
    /// What would be under radiance 1 everywhere: the directional albedo.
    [[nodiscard]] Spectrum albedo() const { return albedo_; }

    /// The integrand's factors in a texel: f·|cos θ| (1/sr), by tile unless `exact`, and incident radiance.
    /// `reflected()` is the sum of their products times the texels' solid angle, up to rounding.
    [[nodiscard]] Spectrum bsdf_at(std::uint32_t texel) const;
    [[nodiscard]] MapRadiance radiance_at(std::uint32_t texel) const;

    /// What would be reflected of one map's radiance alone, luminance, tile by tile: of use in proportions.
    [[nodiscard]] float reflected_of(const BlockMap& map) const;

    /// Estimates by tile how much the true integrand differs from this one: the standard deviation of its
    /// luminance, 1/sr times radiance. From how radiance varies within the tile and between the maps, how f
    /// does, and what no map knows.
    void estimate_deviations();
    [[nodiscard]] std::span<const float> deviations() const { return deviation_; }
    /// The integral over that: the most that `reflected()` may be wrong by if all tiles err the same way.
    [[nodiscard]] float deviation() const;
    /// How the tile's deviation divides among its texels, in any unit.
    [[nodiscard]] std::array<float, tile_texels> texel_shares(std::uint32_t tile) const;

    [[nodiscard]] const DirectionGrid& grid() const { return grid_; }

  private:
    void evaluate_tiles();
    void find_lobe_shares();
    void list_fine_tiles();
    void evaluate_texels();
    void sum();
    void list_open_tiles();
    [[nodiscard]] Spectrum environment_detail();
    [[nodiscard]] float fine_deviation(std::size_t k, float level) const;
    [[nodiscard]] float bsdf_range(std::size_t k) const;
    [[nodiscard]] BsdfPlanes tile_bsdf();
    [[nodiscard]] BsdfPlanes texel_bsdf();

    const DirectionGrid& grid_;
    const QuadraturePoints& points_;
    const DimEnvironment& environment_;
    bool exact_;
    Blend blend_;                                  // of the last run
    std::array<std::vector<float>, 3> tile_bsdf_;  // 0 but in tiles of tier `one`
    std::array<std::vector<float>, 3> matte_;      // at the tiles' centres, without the lobe
    std::vector<float> lobe_share_;                // of f there, by tile
    std::vector<float> luminance_, variance_;      // of radiance, by tile
    std::vector<std::uint16_t> known_;             // by tile: texels that all maps know
    std::vector<TileTier> tiers_;
    std::vector<std::uint32_t> fine_tiles_;                        // of more than one point, tier by tier
    std::array<std::size_t, fine_tiers.size() + 1> tier_begin_{};  // of fine_tiles_
    std::vector<std::uint32_t> fine_index_;                        // by tile
    std::array<std::vector<float>, 3> texel_bsdf_;                 // by fine tile and texel
    std::vector<std::uint32_t> open_tiles_;                        // of fine_tiles_, see list_open_tiles
    std::array<std::size_t, fine_tiers.size() + 1> open_begin_{};  // of open_tiles_, by tier
    std::array<std::vector<float>, 3> detail_;  // by open tile and texel, see environment_detail
    std::vector<TexelSums> texel_sums_;         // by fine tile
    std::vector<float> deviation_;
    ReceiverBsdf receiver_;  // of the last run, and its geometric normal
    Vec3 normal_;
    MapRadiance reflected_;
    Spectrum albedo_;
};

}  // namespace relumine
