// SPDX-License-Identifier: Apache-2.0
// Integrating over tiles.
#include "blocks/map_integral.hpp"

#include <numeric>

namespace relumine {
namespace {

/// What a texel's radiance may deviate by where it is known and where it is not, against the radiance.
constexpr float known_deviation = 0.05f, unknown_deviation = 0.5f;

/// What decides the tiers for a receiver. Of several lobes the sharpest does, which asks for no less than the
/// others anywhere; sheen, whose crest lies along the horizon, for all texels.
TierQuery tier_query(const ReceiverBsdf& b, Vec3 geometric_normal, bool exact) {
    const Vec3 w_out = b.shading_x * b.w_out.v.x + b.shading_y * b.w_out.v.y + b.shading_z * b.w_out.v.z;
    const float alpha = has_ggx_lobe(b) ? sharpest_alpha(b) : 0;
    TierQuery query{geometric_normal, b.shading_z, w_out, alpha, exact || has_sheen_lobe(b), 0, 0, {}, {}};
    if (is_anisotropic(b.ggx)) {
        const float clearcoat = has_clearcoat_lobe(b) ? b.over.clearcoat_alpha : infinity;
        query.alpha_x = std::min(alpha_x(b.ggx), clearcoat);
        query.alpha_y = std::min(alpha_y(b.ggx), clearcoat);
        query.axis_x = b.shading_x;
        query.axis_y = b.shading_y;
    }
    return query;
}

}  // namespace

MapIntegral::MapIntegral(const DirectionGrid& grid, const QuadraturePoints& points,
                         const DimEnvironment& environment, bool exact)
    : grid_(grid),
      points_(points),
      environment_(environment),
      exact_(exact),
      lobe_share_(grid_.tiles),
      luminance_(grid_.tiles),
      variance_(grid_.tiles),
      known_(grid_.tiles),
      tiers_(grid_.tiles),
      fine_index_(grid_.tiles),
      deviation_(grid_.tiles) {
    for (auto* planes : {&tile_bsdf_, &matte_})
        for (auto& plane : *planes) plane.resize(grid_.tiles);
}

BsdfPlanes MapIntegral::tile_bsdf() {
    return {{tile_bsdf_[0].data(), tile_bsdf_[1].data(), tile_bsdf_[2].data()}};
}
BsdfPlanes MapIntegral::texel_bsdf() {
    return {{texel_bsdf_[0].data(), texel_bsdf_[1].data(), texel_bsdf_[2].data()}};
}

void MapIntegral::run(const Blend& blend, const ReceiverBsdf& bsdf, Vec3 geometric_normal) {
    blend_ = blend;
    receiver_ = bsdf;
    normal_ = geometric_normal;
    blend_tiles(blend_, {luminance_, variance_, known_});
    const TierQuery query = tier_query(bsdf, geometric_normal, exact_);
    evaluate_tiles();
    if (query.alpha > 0) find_lobe_shares();
    choose_tiers(grid_, query, {lobe_share_, luminance_, variance_, known_}, tiers_);
    list_fine_tiles();
    evaluate_texels();
    sum();
}

/// At the tiles' centres, times the length of their mean direction: exact where f is the same everywhere.
void MapIntegral::evaluate_tiles() {
    evaluate(receiver_, {grid_.tile_x, grid_.tile_y, grid_.tile_z},
             {tile_bsdf_[0], tile_bsdf_[1], tile_bsdf_[2]});
    for (auto& plane : tile_bsdf_)
        for (std::size_t tile = 0; tile < grid_.tiles; ++tile) plane[tile] *= grid_.tile_length[tile];
}

/// At the tiles' centres.
void MapIntegral::find_lobe_shares() {
    evaluate(without_lobes(receiver_), {grid_.tile_x, grid_.tile_y, grid_.tile_z},
             {matte_[0], matte_[1], matte_[2]});
    for (std::size_t tile = 0; tile < grid_.tiles; ++tile) {
        const float all = luminance({tile_bsdf_[0][tile], tile_bsdf_[1][tile], tile_bsdf_[2][tile]})
                          / grid_.tile_length[tile];
        const float diffuse = luminance({matte_[0][tile], matte_[1][tile], matte_[2][tile]});
        lobe_share_[tile] = all > 0 ? std::max(0.0f, 1 - diffuse / all) : 1;
    }
}

void MapIntegral::list_fine_tiles() {
    fine_tiles_.clear();
    for (std::size_t t = 0; t < fine_tiers.size(); ++t) {
        tier_begin_[t] = fine_tiles_.size();
        for (std::uint32_t tile = 0; tile < grid_.tiles; ++tile) {
            if (tiers_[tile] != fine_tiers[t]) continue;
            fine_index_[tile] = static_cast<std::uint32_t>(fine_tiles_.size());
            fine_tiles_.push_back(tile);
        }
    }
    tier_begin_.back() = fine_tiles_.size();
}

void MapIntegral::evaluate_texels() {
    for (auto& plane : texel_bsdf_) plane.resize(fine_tiles_.size() * tile_texels);
    for (std::size_t t = 0; t < fine_tiers.size(); ++t) {
        const std::size_t first = tier_begin_[t], count = tier_begin_[t + 1] - first;
        if (count == 0) continue;
        const auto out = [&](std::size_t c) {
            return std::span(texel_bsdf_[c]).subspan(first * tile_texels, count * tile_texels);
        };
        relumine::evaluate_tiles(receiver_, normal_, points_.tiers[t], points_per_texel(t),
                                 std::span(fine_tiles_).subspan(first, count), {out(0), out(1), out(2)});
    }
}

void MapIntegral::sum() {
    const ReflectedSums by_tile = sum_tiles(grid_, receiver_.shading_z, blend_, tiers_, tile_bsdf());
    texel_sums_.resize(fine_tiles_.size());
    const ReflectedSums by_texel = sum_texels(blend_, fine_tiles_, texel_bsdf(), texel_sums_);
    const float texel = grid_.texel_solid_angle, tile = texel * tile_texels;
    reflected_ = {by_tile.direct * tile + by_texel.direct * texel,
                  by_tile.indirect * tile + by_texel.indirect * texel};
    if (!exact_) reflected_.direct += environment_detail() * texel;
    albedo_ = by_tile.albedo * tile + by_texel.albedo * texel;
}

/// Fine tiles of more than one point per texel, tier by tier, of which a map leaves some open: the others
/// show nothing of the environment.
void MapIntegral::list_open_tiles() {
    open_tiles_.clear();
    const auto is_open = [&](std::uint32_t tile) {
        return std::ranges::any_of(blend_.maps(), [&](const auto& m) { return m.map->open[tile] != 0; });
    };
    for (std::size_t t = 1; t < fine_tiers.size(); ++t) {
        open_begin_[t] = open_tiles_.size();
        std::copy_if(fine_tiles_.begin() + static_cast<std::ptrdiff_t>(tier_begin_[t]),
                     fine_tiles_.begin() + static_cast<std::ptrdiff_t>(tier_begin_[t + 1]),
                     std::back_inserter(open_tiles_), is_open);
    }
    open_begin_.back() = open_tiles_.size();
}

/// What open texels reflect of the environment beyond what their means do: the mean of the product less the
/// product of the means.
Spectrum MapIntegral::environment_detail() {
    list_open_tiles();
    if (open_tiles_.empty()) return {};
    for (auto& plane : detail_) plane.resize(open_tiles_.size() * tile_texels);
    for (std::size_t t = 1; t < fine_tiers.size(); ++t) {
        const std::size_t first = open_begin_[t], count = open_begin_[t + 1] - first;
        const auto out = [&](std::size_t c) {
            return std::span(detail_[c]).subspan(first * tile_texels, count * tile_texels);
        };
        evaluate_products(receiver_, normal_, points_.tiers[t], environment_.points[t], points_per_texel(t),
                          std::span(open_tiles_).subspan(first, count), {out(0), out(1), out(2)});
    }
    for (std::size_t k = 0; k < open_tiles_.size(); ++k)
        for (std::size_t i = 0; i < tile_texels; ++i) {
            const std::size_t at = k * tile_texels + i, from = fine_index_[open_tiles_[k]] * tile_texels + i;
            const Spectrum mean = environment_.texels[open_tiles_[k] * tile_texels + i];
            detail_[0][at] -= texel_bsdf_[0][from] * mean.r;
            detail_[1][at] -= texel_bsdf_[1][from] * mean.g;
            detail_[2][at] -= texel_bsdf_[2][from] * mean.b;
        }
    return sum_open(blend_, open_tiles_, {{detail_[0].data(), detail_[1].data(), detail_[2].data()}});
}

float MapIntegral::reflected_of(const BlockMap& map) const {
    float sum = 0;
    for (std::size_t tile = 0; tile < grid_.tiles; ++tile)
        sum += luminance({tile_bsdf_[0][tile], tile_bsdf_[1][tile], tile_bsdf_[2][tile]})
               * map.tile_luminance[tile];
    for (std::size_t k = 0; k < fine_tiles_.size(); ++k)
        sum += texel_sums_[k].bsdf / tile_texels * map.tile_luminance[fine_tiles_[k]];
    return sum;
}

void MapIntegral::estimate_deviations() {
    for (std::size_t tile = 0; tile < grid_.tiles; ++tile) {
        const float value = luminance({tile_bsdf_[0][tile], tile_bsdf_[1][tile], tile_bsdf_[2][tile]});
        deviation_[tile] = value * (std::sqrt(variance_[tile]) + known_deviation * luminance_[tile]);
    }
    const float level =
        luminance(reflected_.direct + reflected_.indirect) / std::max(luminance(albedo_), 1e-9f);
    for (std::size_t k = 0; k < fine_tiles_.size(); ++k)
        deviation_[fine_tiles_[k]] = fine_deviation(k, level);
}

float MapIntegral::deviation() const {
    return std::accumulate(deviation_.begin(), deviation_.end(), 0.0f) * grid_.texel_solid_angle
           * tile_texels;
}

/// `level`: the mean radiance that the receiver sees, for what is unknown.
float MapIntegral::fine_deviation(std::size_t k, float level) const {
    const std::size_t tile = fine_tiles_[k];
    const float unknown = unknown_deviation * texel_sums_[k].unknown / tile_texels * level;
    const float radiance = std::sqrt(variance_[tile]) + known_deviation * luminance_[tile] + unknown;
    return texel_sums_[k].bsdf / tile_texels * radiance + (exact_ ? bsdf_range(k) / 8 * luminance_[tile] : 0);
}

float MapIntegral::bsdf_range(std::size_t k) const {
    float least = infinity, most = 0;
    for (std::size_t i = k * tile_texels; i < (k + 1) * tile_texels; ++i) {
        const float value = luminance({texel_bsdf_[0][i], texel_bsdf_[1][i], texel_bsdf_[2][i]});
        least = std::min(least, value);
        most = std::max(most, value);
    }
    return most - least;
}

Spectrum MapIntegral::bsdf_at(std::uint32_t texel) const {
    const std::size_t tile = texel / tile_texels;
    const auto from = [](const auto& planes, std::size_t i) {
        return Spectrum{planes[0][i], planes[1][i], planes[2][i]};
    };
    if (tiers_[tile] == TileTier::below) return {};
    if (tiers_[tile] == TileTier::one) return from(tile_bsdf_, tile);
    return from(texel_bsdf_, fine_index_[tile] * tile_texels + texel % tile_texels);
}

MapRadiance MapIntegral::radiance_at(std::uint32_t texel) const {
    MapRadiance sum;
    float known = 0;
    for (const auto& [map, weight] : blend_.maps()) {
        if (!(map->known[texel / tile_texels] >> texel % tile_texels & 1)) continue;
        known += weight;
        sum.direct += map->direct.at(texel) * weight;
        if (!map->indirect.empty()) sum.indirect += map->indirect.at(texel) * weight;
    }
    if (known > 0) return {sum.direct / known, sum.indirect / known};
    return {};
}

std::array<float, tile_texels> MapIntegral::texel_shares(std::uint32_t tile) const {
    std::array<float, tile_texels> shares;
    shares.fill(1);
    if (tiers_[tile] <= TileTier::one) return shares;
    const std::size_t first = fine_index_[tile] * tile_texels;
    float sum = 0;
    for (std::size_t i = 0; i < tile_texels; ++i)
        sum += shares[i] =
            luminance({texel_bsdf_[0][first + i], texel_bsdf_[1][first + i], texel_bsdf_[2][first + i]});
    for (float& share : shares) share += 0.05f * sum / tile_texels + 1e-30f;
    return shares;
}

}  // namespace relumine
