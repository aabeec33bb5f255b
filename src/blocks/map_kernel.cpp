// SPDX-License-Identifier: Apache-2.0
// The kernels of MapIntegral.
#include "blocks/map_kernel.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "blocks/map_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace relumine::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using F = hn::CappedTag<float, tile_texels>;
using I = hn::RebindToSigned<F>;
using U8 = hn::Rebind<std::uint8_t, F>;
using VF = hn::Vec<F>;

HWY_INLINE VF constant(float x) { return hn::Set(F(), x); }
HWY_INLINE VF squared(VF x) { return hn::Mul(x, x); }

HWY_INLINE float lane_sum(VF x) { return hn::GetLane(hn::SumOfLanes(F(), x)); }

struct Sums {
    VF r, g, b;

    HWY_INLINE Sums() : r(hn::Zero(F())), g(hn::Zero(F())), b(hn::Zero(F())) {}

    HWY_INLINE void add(const BsdfPlanes& f, std::size_t at, VF x, VF y, VF z) {
        r = hn::MulAdd(hn::LoadU(F(), f.channel[0] + at), x, r);
        g = hn::MulAdd(hn::LoadU(F(), f.channel[1] + at), y, g);
        b = hn::MulAdd(hn::LoadU(F(), f.channel[2] + at), z, b);
    }
    [[nodiscard]] HWY_INLINE Spectrum total() const { return {lane_sum(r), lane_sum(g), lane_sum(b)}; }
};

void blend_all(const Blend& blend, const BlendedTiles& out) {
    const F f;
    const std::size_t lanes = hn::Lanes(f);
    for (std::size_t tile = 0; tile < out.luminance.size(); tile += lanes) {
        VF mean = hn::Zero(f), squares = hn::Zero(f);
        for (const auto& [map, weight] : blend.maps()) {
            const VF l = hn::LoadU(f, &map->tile_luminance[tile]), w = constant(weight);
            mean = hn::MulAdd(w, l, mean);
            squares = hn::MulAdd(w, hn::MulAdd(l, l, hn::LoadU(f, &map->tile_variance[tile])), squares);
        }
        hn::StoreU(mean, f, &out.luminance[tile]);
        hn::StoreU(hn::Max(hn::NegMulAdd(mean, mean, squares), hn::Zero(f)), f, &out.variance[tile]);
    }
    for (std::size_t tile = 0; tile < out.known.size(); ++tile) out.known[tile] = whole_tile;
    for (const WeightedMap& m : blend.maps())
        for (std::size_t tile = 0; tile < out.known.size(); ++tile) out.known[tile] &= m.map->known[tile];
}

struct Vec3s {
    VF x, y, z;
};
HWY_INLINE VF dot(const Vec3s& a, Vec3 b) {
    return hn::MulAdd(a.x, constant(b.x), hn::MulAdd(a.y, constant(b.y), hn::Mul(a.z, constant(b.z))));
}

/// A midpoint rule's error, relative to the value, may be so large; and so large what it misses where the
/// lobe and radiance both vary within a tile, if they do so together.
constexpr float quadrature_tolerance = 0.004f, covariance_tolerance = 0.01f;

/// Of one point per tile for a GGX lobe, relative to its value.
struct LobeErrors {
    VF curvature;  // of the midpoint rule
    VF slope;      // the lobe's standard deviation within the tile
};

/// From the sum of curvatures and the square of the gradient by half vector, per rad². The half vector moves
/// half as much as the direction in the plane of incidence and 1 / |w_in + w_out| as much across it; over a
/// square of side s the midpoint rule's error is s²/24 times the Laplacian, and the variance s²/12 times the
/// gradient's square. `side2`: of half the tile's side.
HWY_INLINE LobeErrors lobe_errors(VF curvatures, VF gradient2, VF half_length2, float side2) {
    const VF axes = hn::Mul(
        hn::MulAdd(constant(2), hn::Div(constant(1), hn::Max(half_length2, constant(1e-6f))), constant(0.5f)),
        constant(side2 / 24));  // the mean of the squares, against half as much along both axes
    return {hn::Mul(axes, curvatures), hn::Sqrt(hn::Mul(axes, hn::Mul(constant(2), gradient2)))};
}

/// The Laplacian is (20 t² − 4) / (α² (1 + t²)²) of the value and the gradient 4 t / (α (1 + t²)),
/// t = tan θ_m / α.
HWY_INLINE LobeErrors round_lobe_errors(const Vec3s& d, const TierQuery& q, float side2) {
    const F f;
    const Vec3s half{hn::Add(d.x, constant(q.w_out.x)), hn::Add(d.y, constant(q.w_out.y)),
                     hn::Add(d.z, constant(q.w_out.z))};
    const VF z2 = hn::Max(squared(dot(half, q.shading_normal)), constant(1e-12f));
    const VF length2 = hn::MulAdd(half.x, half.x, hn::MulAdd(half.y, half.y, squared(half.z)));
    const float inverse_alpha2 = 1 / sqr(q.alpha);
    const VF t2 = hn::Mul(hn::Div(hn::Max(hn::Sub(length2, z2), hn::Zero(f)), z2), constant(inverse_alpha2));
    const VF scale = hn::Div(constant(inverse_alpha2), squared(hn::Add(t2, constant(1))));
    return lobe_errors(hn::Mul(hn::MulAdd(t2, constant(20), constant(4)), scale),
                       hn::Mul(hn::Mul(t2, constant(16)), scale), length2, side2);
}

/// The same of a lobe with two roughnesses: of the curvatures along its axes the larger.
HWY_INLINE LobeErrors stretched_lobe_errors(const Vec3s& d, const TierQuery& q, float side2) {
    const F f;
    const Vec3s half{hn::Add(d.x, constant(q.w_out.x)), hn::Add(d.y, constant(q.w_out.y)),
                     hn::Add(d.z, constant(q.w_out.z))};
    const VF z2 = hn::Max(squared(dot(half, q.shading_normal)), constant(1e-12f));
    const VF length2 = hn::MulAdd(half.x, half.x, hn::MulAdd(half.y, half.y, squared(half.z)));
    const float inverse_x2 = 1 / sqr(q.alpha_x), inverse_y2 = 1 / sqr(q.alpha_y);
    const VF x2 = hn::Div(hn::Mul(squared(dot(half, q.axis_x)), constant(inverse_x2)), z2);
    const VF y2 = hn::Div(hn::Mul(squared(dot(half, q.axis_y)), constant(inverse_y2)), z2);
    const auto curvature = [&](VF along, VF across, float inverse_alpha2) {
        const VF numerator = hn::MulAdd(along, constant(20), hn::MulAdd(across, constant(4), constant(4)));
        return hn::Mul(numerator, constant(inverse_alpha2));
    };
    const VF most = hn::Max(curvature(x2, y2, inverse_x2), curvature(y2, x2, inverse_y2));
    const VF gradient2 =
        hn::Mul(constant(16), hn::MulAdd(x2, constant(inverse_x2), hn::Mul(y2, constant(inverse_y2))));
    const VF spread2 = squared(hn::Add(hn::Add(x2, y2), hn::Set(f, 1)));
    return lobe_errors(hn::Div(most, spread2), hn::Div(gradient2, spread2), length2, side2);
}

void choose_all(const DirectionGrid& grid, const TierQuery& q, const TileContent& content,
                std::span<TileTier> tiers) {
    const F f;
    const I i;
    const std::size_t lanes = hn::Lanes(f);
    const float side2 = grid.texel_solid_angle * tile_texels / 4;
    const auto tier = [&](TileTier t) { return hn::Set(i, static_cast<std::int32_t>(t)); };
    for (std::size_t tile = 0; tile < tiers.size(); tile += lanes) {
        const Vec3s d{hn::LoadU(f, &grid.tile_x[tile]), hn::LoadU(f, &grid.tile_y[tile]),
                      hn::LoadU(f, &grid.tile_z[tile])};
        const VF sine = hn::LoadU(f, &grid.tile_sine[tile]);
        const VF above = hn::Min(dot(d, q.geometric_normal), dot(d, q.shading_normal));
        const hn::Rebind<std::uint16_t, F> u16;
        const auto whole =
            hn::Eq(hn::PromoteTo(i, hn::LoadU(u16, &content.known[tile])), hn::Set(i, whole_tile));
        const auto fine = hn::Or(hn::RebindMask(i, hn::Lt(above, sine)), hn::Not(whole));
        auto chosen = tier(q.exact ? TileTier::texels : TileTier::one);
        chosen = hn::IfThenElse(fine, tier(TileTier::texels), chosen);
        if (q.alpha > 0) {
            const LobeErrors lobe =
                q.alpha_x == q.alpha_y ? round_lobe_errors(d, q, side2) : stretched_lobe_errors(d, q, side2);
            const VF share = hn::LoadU(f, &content.lobe_share[tile]);
            const VF deviation = hn::Div(hn::Sqrt(hn::LoadU(f, &content.variance[tile])),
                                         hn::Max(hn::LoadU(f, &content.luminance[tile]), constant(1e-30f)));
            const auto raise = [&](VF error, float tolerance, TileTier t) {
                const auto large = hn::Gt(hn::Mul(share, error), constant(tolerance));
                chosen = hn::IfThenElse(hn::RebindMask(i, large), tier(t), chosen);
            };
            raise(hn::Mul(lobe.slope, deviation), covariance_tolerance, TileTier::texels);
            raise(lobe.curvature, quadrature_tolerance, TileTier::texels);
            raise(lobe.curvature, 16 * quadrature_tolerance, TileTier::quarters);
            raise(lobe.curvature, 64 * quadrature_tolerance, TileTier::sixteenths);
        }
        const auto below = hn::RebindMask(i, hn::Lt(above, hn::Neg(sine)));
        chosen = hn::IfThenElse(below, tier(TileTier::below), chosen);
        hn::StoreU(hn::DemoteTo(U8(), chosen), U8(), reinterpret_cast<std::uint8_t*>(&tiers[tile]));
    }
}

/// Radiance times cosine, over a blend.
HWY_INLINE VF blended(const Blend& blend, const RadiancePlanes BlockMap::*planes, std::size_t channel,
                      std::size_t tile, Vec3 normal) {
    const F f;
    Vec3s sum{hn::Zero(f), hn::Zero(f), hn::Zero(f)};
    for (const auto& [map, weight] : blend.maps()) {
        const auto& moments = (map->*planes).tile_moments[channel];
        sum.x = hn::MulAdd(constant(weight), hn::LoadU(f, &moments[0][tile]), sum.x);
        sum.y = hn::MulAdd(constant(weight), hn::LoadU(f, &moments[1][tile]), sum.y);
        sum.z = hn::MulAdd(constant(weight), hn::LoadU(f, &moments[2][tile]), sum.z);
    }
    return dot(sum, normal);
}

void sum_tiles_all(const DirectionGrid& grid, Vec3 normal, const Blend& blend,
                   std::span<const TileTier> tiers, const BsdfPlanes& bsdf, ReflectedSums& out) {
    const F f;
    const I i;
    const std::size_t lanes = hn::Lanes(f);
    const bool with_indirect = !blend.maps()[0].map->indirect.empty();
    Sums direct, indirect, albedo;
    for (std::size_t tile = 0; tile < tiers.size(); tile += lanes) {
        const auto tier =
            hn::PromoteTo(i, hn::LoadU(U8(), reinterpret_cast<const std::uint8_t*>(&tiers[tile])));
        const auto one =
            hn::RebindMask(f, hn::Eq(tier, hn::Set(i, static_cast<std::int32_t>(TileTier::one))));
        for (float* channel : bsdf.channel)
            hn::StoreU(hn::IfThenElseZero(one, hn::LoadU(f, channel + tile)), f, channel + tile);
        if (hn::AllFalse(f, one)) continue;
        const Vec3s d{hn::LoadU(f, &grid.tile_x[tile]), hn::LoadU(f, &grid.tile_y[tile]),
                      hn::LoadU(f, &grid.tile_z[tile])};
        const VF cosine = hn::Mul(dot(d, normal), hn::LoadU(f, &grid.tile_length[tile]));  // its mean
        const VF scale = hn::Div(constant(1), hn::Max(cosine, constant(1e-6f)));
        const auto radiance = [&](const RadiancePlanes BlockMap::*planes, std::size_t channel) {
            return hn::Mul(scale, blended(blend, planes, channel, tile, normal));
        };
        direct.add(bsdf, tile, radiance(&BlockMap::direct, 0), radiance(&BlockMap::direct, 1),
                   radiance(&BlockMap::direct, 2));
        if (with_indirect)
            indirect.add(bsdf, tile, radiance(&BlockMap::indirect, 0), radiance(&BlockMap::indirect, 1),
                         radiance(&BlockMap::indirect, 2));
        albedo.add(bsdf, tile, constant(1), constant(1), constant(1));
    }
    out = {direct.total(), indirect.total(), albedo.total()};
}

struct TexelRun {
    VF sums[6];  // of weighted radiance: direct, indirect
    VF weight;   // of the maps that know the texel
};

/// `weight` in the lanes whose bit of a tile's sixteen is set.
HWY_INLINE VF weight_of_bits(std::uint16_t bits, std::size_t lane, float weight) {
    const std::uint32_t shifted = static_cast<std::uint32_t>(bits) >> lane;
    const std::uint8_t bytes[8] = {static_cast<std::uint8_t>(shifted),
                                   static_cast<std::uint8_t>(shifted >> 8)};
    return hn::IfThenElseZero(hn::LoadMaskBits(F(), bytes), constant(weight));
}

HWY_INLINE TexelRun gather_texels(const Blend& blend, std::size_t tile, std::size_t lane,
                                  bool with_indirect) {
    const F f;
    TexelRun run;
    for (VF& sum : run.sums) sum = hn::Zero(f);
    run.weight = hn::Zero(f);
    const std::size_t first = tile * tile_texels + lane;
    for (const auto& [map, weight] : blend.maps()) {
        if (map->known[tile] == 0) continue;
        const VF w = weight_of_bits(map->known[tile], lane, weight);
        run.weight = hn::Add(run.weight, w);
        for (std::size_t c = 0; c < 3; ++c)
            run.sums[c] = hn::MulAdd(w, hn::LoadU(f, &map->direct.texels[c][first]), run.sums[c]);
        for (std::size_t c = 0; c < 3 && with_indirect; ++c)
            run.sums[3 + c] = hn::MulAdd(w, hn::LoadU(f, &map->indirect.texels[c][first]), run.sums[3 + c]);
    }
    return run;
}

void sum_texels_all(const Blend& blend, std::span<const std::uint32_t> tiles, const BsdfPlanes& bsdf,
                    std::span<TexelSums> by_tile, ReflectedSums& out) {
    const F f;
    const bool with_indirect = !blend.maps()[0].map->indirect.empty();
    Sums direct, indirect, albedo;
    for (std::size_t k = 0; k < tiles.size(); ++k) {
        std::size_t holes = 0;
        VF luminance = hn::Zero(f);
        for (std::size_t lane = 0; lane < tile_texels; lane += hn::Lanes(f)) {
            const std::size_t at = k * tile_texels + lane;
            const TexelRun run = gather_texels(blend, tiles[k], lane, with_indirect);
            const auto any = hn::Gt(run.weight, hn::Zero(f));
            holes += hn::Lanes(f) - hn::CountTrue(f, any);
            const VF scale =
                hn::IfThenElseZero(any, hn::Div(constant(1), hn::Max(run.weight, constant(1e-30f))));
            direct.add(bsdf, at, hn::Mul(run.sums[0], scale), hn::Mul(run.sums[1], scale),
                       hn::Mul(run.sums[2], scale));
            if (with_indirect)
                indirect.add(bsdf, at, hn::Mul(run.sums[3], scale), hn::Mul(run.sums[4], scale),
                             hn::Mul(run.sums[5], scale));
            const VF red = hn::LoadU(f, bsdf.channel[0] + at), green = hn::LoadU(f, bsdf.channel[1] + at),
                     blue = hn::LoadU(f, bsdf.channel[2] + at);
            albedo.r = hn::Add(albedo.r, red);
            albedo.g = hn::Add(albedo.g, green);
            albedo.b = hn::Add(albedo.b, blue);
            luminance = hn::MulAdd(
                red, constant(0.2126f),
                hn::MulAdd(green, constant(0.7152f), hn::MulAdd(blue, constant(0.0722f), luminance)));
        }
        by_tile[k] = {lane_sum(luminance), static_cast<float>(holes)};
    }
    out = {direct.total(), indirect.total(), albedo.total()};
}

void sum_open_all(const Blend& blend, std::span<const std::uint32_t> tiles, const BsdfPlanes& detail,
                  Spectrum& out) {
    const F f;
    Sums sums;
    for (std::size_t k = 0; k < tiles.size(); ++k)
        for (std::size_t lane = 0; lane < tile_texels; lane += hn::Lanes(f)) {
            VF open = hn::Zero(f), known = hn::Zero(f);
            for (const auto& [map, weight] : blend.maps()) {
                open = hn::Add(open, weight_of_bits(map->open[tiles[k]], lane, weight));
                known = hn::Add(known, weight_of_bits(map->known[tiles[k]], lane, weight));
            }
            const VF share = hn::Div(open, hn::Max(known, constant(1e-30f)));
            sums.add(detail, k * tile_texels + lane, share, share, share);
        }
    out = sums.total();
}

}  // namespace
}  // namespace relumine::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace relumine {

HWY_EXPORT(blend_all);
HWY_EXPORT(choose_all);
HWY_EXPORT(sum_tiles_all);
HWY_EXPORT(sum_texels_all);
HWY_EXPORT(sum_open_all);

void blend_tiles(const Blend& blend, const BlendedTiles& out) { HWY_DYNAMIC_DISPATCH(blend_all)(blend, out); }

void choose_tiers(const DirectionGrid& grid, const TierQuery& query, const TileContent& content,
                  std::span<TileTier> tiers) {
    HWY_DYNAMIC_DISPATCH(choose_all)(grid, query, content, tiers);
}

ReflectedSums sum_tiles(const DirectionGrid& grid, Vec3 shading_normal, const Blend& blend,
                        std::span<const TileTier> tiers, const BsdfPlanes& bsdf) {
    ReflectedSums sums;
    HWY_DYNAMIC_DISPATCH(sum_tiles_all)(grid, shading_normal, blend, tiers, bsdf, sums);
    return sums;
}

ReflectedSums sum_texels(const Blend& blend, std::span<const std::uint32_t> tiles, const BsdfPlanes& bsdf,
                         std::span<TexelSums> by_tile) {
    ReflectedSums sums;
    HWY_DYNAMIC_DISPATCH(sum_texels_all)(blend, tiles, bsdf, by_tile, sums);
    return sums;
}

Spectrum sum_open(const Blend& blend, std::span<const std::uint32_t> tiles, const BsdfPlanes& detail) {
    Spectrum sum;
    HWY_DYNAMIC_DISPATCH(sum_open_all)(blend, tiles, detail, sum);
    return sum;
}

}  // namespace relumine
#endif
