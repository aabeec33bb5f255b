// SPDX-License-Identifier: Apache-2.0
// The BSDF kernel: the formulas of shading/metallic_roughness.cpp for as many directions as the machine has
// lanes.
#include <array>

#include "cache/receiver_bsdf.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "cache/receiver_bsdf_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "cache/cells-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace relumine::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using F = hn::CappedTag<float, 16>;
using VF = hn::Vec<F>;

HWY_INLINE VF constant(float x) { return hn::Set(F(), x); }
HWY_INLINE VF squared(VF x) { return hn::Mul(x, x); }

struct Vec3s {
    VF x, y, z;
};
HWY_INLINE VF dot(const Vec3s& a, Vec3 b) {
    return hn::MulAdd(a.x, constant(b.x), hn::MulAdd(a.y, constant(b.y), hn::Mul(a.z, constant(b.z))));
}

struct Spectrums {
    VF r, g, b;
};
/// Schlick's Fresnel from (1 − cos)⁵.
HWY_INLINE Spectrums schlick(Spectrum f0, Spectrum f90, VF grazing) {
    const auto channel = [&](float at0, float at90) {
        return hn::MulAdd(constant(at90 - at0), grazing, constant(at0));
    };
    return {channel(f0.r, f90.r), channel(f0.g, f90.g), channel(f0.b, f90.b)};
}

/// What does not depend on w_in.
struct Prepared {
    const ReceiverBsdf& b;
    float a2, lambda_out, scale;       // of the specular lobe: D·G without what follows from w_in
    float squeeze_x, squeeze_y;        // of the axes in the density, against Λ's
    std::array<float, 3> flat, steep;  // of grazing_albedo, for the mean α and both others
    std::array<float, 3> inverse_steep;
    Spectrum diffuse;  // times what the coat lets pass to w_out

    explicit Prepared(const ReceiverBsdf& bsdf) : b(bsdf), a2(sqr(bsdf.ggx.alpha)) {
        const Vec3 o = b.w_out.v;
        lambda_out = 0.5f * (std::sqrt(1 + a2 * stretched2(b.ggx, b.w_out) / sqr(o.z)) - 1);
        scale = a2 * inv_pi / (4 * o.z);
        squeeze_x = b.ggx.stretch_y;
        squeeze_y = b.ggx.stretch_x;
        const std::array<float, 3> alphas = grazing_alphas(b.ggx);
        for (std::size_t i = 0; i < alphas.size(); ++i) {
            flat[i] = std::max(1 - 6 * alphas[i], 0.0f);
            steep[i] = 20 * sqr(alphas[i]) / (alphas[i] + 0.02f);
            inverse_steep[i] = 1 / steep[i];
        }
        diffuse = b.diffuse;
        if (b.coated)
            diffuse *=
                1
                - std::min(1.0f,
                           max_component(b.coat_f0 + (b.coat_f90 - b.coat_f0) * grazing_albedo(o.z, b.ggx)));
    }
};

/// x² + y² with the axes scaled, where lobes are `Stretched`.
template <bool Stretched>
HWY_INLINE VF surface_length2(VF x, VF y, float scale_x, float scale_y) {
    if constexpr (Stretched) {
        x = hn::Mul(x, constant(scale_x));
        y = hn::Mul(y, constant(scale_y));
    }
    return hn::MulAdd(x, x, squared(y));
}

/// The coat's grazing albedo.
template <bool Stretched>
HWY_INLINE VF grazing_albedo(const Prepared& p, VF cosine) {
    const VF beside = hn::Min(hn::Max(hn::Sub(constant(1), cosine), constant(1e-3f)), constant(1));
    const VF beside2 = squared(beside);
    const auto at = [&](std::size_t i) {
        // Rough coats are steep alone: no division.
        const VF whole = p.flat[i] == 0
                             ? hn::Mul(hn::Mul(beside2, beside), constant(p.inverse_steep[i]))
                             : hn::Div(hn::Mul(squared(beside2), beside),
                                       hn::MulAdd(constant(p.steep[i]), beside2, constant(p.flat[i])));
        return hn::Min(whole, constant(1));
    };
    if constexpr (!Stretched) return at(0);
    return hn::Max(at(0), hn::Max(at(1), at(2)));
}

/// D·G / (4 cos θ_out) at the half vector with these squared components (the density's), not yet divided by
/// the squared length. One division for those of the density, of Λ and of the masking.
template <bool Stretched>
HWY_INLINE VF lobe(const Prepared& p, const Vec3s& w, VF m_xy2, VF m_z2, VF length2) {
    const VF density_root = hn::MulAdd(constant(p.a2), m_z2, m_xy2);
    const VF z2 = squared(w.z);
    const VF xy2 = surface_length2<Stretched>(w.x, w.y, p.b.ggx.stretch_x, p.b.ggx.stretch_y);
    const VF root = hn::Sqrt(hn::MulAdd(constant(p.a2), xy2, z2));
    // (½ + Λ_in)·cos θ_in = root / 2
    const VF masking = p.b.ggx.masking == Masking::correlated
                           ? hn::MulAdd(constant(0.5f + p.lambda_out), w.z, hn::Mul(constant(0.5f), root))
                           : hn::Mul(constant(0.5f * (1 + p.lambda_out)), hn::Add(w.z, root));
    return hn::Div(hn::Mul(hn::Mul(constant(p.scale), w.z), squared(length2)),
                   hn::Mul(squared(density_root), masking));
}

template <bool Stretched>
HWY_INLINE Spectrums reflect(const Prepared& p, const Vec3s& w) {
    const ReceiverBsdf& b = p.b;
    const VF cosine = hn::Mul(w.z, constant(inv_pi));
    if (!b.specular && !b.coated)
        return {hn::Mul(cosine, constant(p.diffuse.r)), hn::Mul(cosine, constant(p.diffuse.g)),
                hn::Mul(cosine, constant(p.diffuse.b))};
    const Vec3s m{hn::Add(w.x, constant(b.w_out.v.x)), hn::Add(w.y, constant(b.w_out.v.y)),
                  hn::Add(w.z, constant(b.w_out.v.z))};
    const VF m_xy2 = hn::MulAdd(m.x, m.x, squared(m.y)), m_z2 = squared(m.z);
    const VF length2 = hn::Max(hn::Add(m_xy2, m_z2), constant(1e-20f));
    // |w_out + w_in| / 2 = cos of the angle between either and the half vector
    const VF x = hn::Max(hn::NegMulAdd(hn::Sqrt(length2), constant(0.5f), constant(1)), constant(0));
    const VF grazing = hn::Mul(squared(squared(x)), x);
    VF base = cosine;
    if (b.coated) {
        const Spectrums coat = schlick(b.coat_f0, b.coat_f90, grazing_albedo<Stretched>(p, w.z));
        const VF most = hn::Max(coat.r, hn::Max(coat.g, coat.b));
        base = hn::Mul(base, hn::Max(hn::Sub(constant(1), most), constant(0)));
    }
    Spectrums out{hn::Mul(base, constant(p.diffuse.r)), hn::Mul(base, constant(p.diffuse.g)),
                  hn::Mul(base, constant(p.diffuse.b))};
    if (!b.specular) return out;
    const VF density_xy2 = Stretched ? surface_length2<Stretched>(m.x, m.y, p.squeeze_x, p.squeeze_y) : m_xy2;
    const VF specular = lobe<Stretched>(p, w, density_xy2, m_z2, length2);
    const Spectrums fresnel = schlick(b.specular_f0, b.specular_f90, grazing);
    return {hn::MulAdd(specular, fresnel.r, out.r), hn::MulAdd(specular, fresnel.g, out.g),
            hn::MulAdd(specular, fresnel.b, out.b)};
}

template <bool Stretched>
HWY_INLINE Spectrums above_horizon(const Prepared& p, const Vec3s& direction) {
    const Vec3s w{dot(direction, p.b.shading_x), dot(direction, p.b.shading_y),
                  dot(direction, p.b.shading_z)};
    const auto above = hn::Gt(w.z, constant(0));
    const Spectrums s = reflect<Stretched>(p, {w.x, w.y, hn::Max(w.z, constant(1e-7f))});
    return {hn::IfThenElseZero(above, s.r), hn::IfThenElseZero(above, s.g), hn::IfThenElseZero(above, s.b)};
}

template <bool Stretched>
HWY_INLINE void evaluate_as(const ReceiverBsdf& bsdf, const Directions& w_in, const SpectrumArrays& out) {
    const F f;
    const Prepared prepared(bsdf);
    const std::size_t lanes = hn::Lanes(f), count = w_in.x.size(), whole = count / lanes * lanes;
    std::size_t i = 0;
    for (; i < whole; i += lanes) {
        const Spectrums s = above_horizon<Stretched>(
            prepared, {hn::LoadU(f, &w_in.x[i]), hn::LoadU(f, &w_in.y[i]), hn::LoadU(f, &w_in.z[i])});
        hn::StoreU(s.r, f, &out.r[i]);
        hn::StoreU(s.g, f, &out.g[i]);
        hn::StoreU(s.b, f, &out.b[i]);
    }
    for (; i < count; ++i) {
        const Spectrums s = above_horizon<Stretched>(
            prepared, {constant(w_in.x[i]), constant(w_in.y[i]), constant(w_in.z[i])});
        out.r[i] = hn::GetLane(s.r);
        out.g[i] = hn::GetLane(s.g);
        out.b[i] = hn::GetLane(s.b);
    }
}

void evaluate_all(const ReceiverBsdf& bsdf, const Directions& w_in, const SpectrumArrays& out) {
    if (is_anisotropic(bsdf.ggx))
        evaluate_as<true>(bsdf, w_in, out);
    else
        evaluate_as<false>(bsdf, w_in, out);
}

template <bool Stretched>
HWY_INLINE void evaluate_cells_as(const ReceiverBsdf& bsdf, const Directions& centers, const CellMask& wanted,
                                  const SpectrumArrays& out) {
    const F f;
    const Prepared prepared(bsdf);
    constexpr std::size_t side = mask_side / 2;
    for (std::size_t y = 0; y < side; ++y)
        for (std::size_t x = 0; x < side; x += hn::Lanes(f)) {
            if (!cells::any_in_lanes(wanted[y], x)) continue;
            const std::size_t at = y * side + x;
            const Spectrums s = above_horizon<Stretched>(
                prepared,
                {hn::LoadU(f, &centers.x[at]), hn::LoadU(f, &centers.y[at]), hn::LoadU(f, &centers.z[at])});
            hn::StoreU(s.r, f, &out.r[at]);
            hn::StoreU(s.g, f, &out.g[at]);
            hn::StoreU(s.b, f, &out.b[at]);
        }
}

/// Radiance over a row of tiles of 4 × 4 bits. `all_lit`: all bits are, and none need be asked.
class TileRow {
  public:
    TileRow(const std::uint32_t* radiance, const MaskRow* lit) : radiance_(radiance), lit_(lit) {}

    /// Σ over each of Lanes tiles from the one whose bits begin at `x` on.
    template <bool all_lit>
    HWY_INLINE cells::Colors tiles(std::size_t x) const {
        const auto pairs = [&](std::size_t from) HWY_ATTR {
            return add_pairs(columns<all_lit>(from), columns<all_lit>(from + hn::Lanes(F())));
        };
        return add_pairs(pairs(x), pairs(x + 2 * hn::Lanes(F())));
    }

  private:
    /// Σ over four rows of Lanes columns from `x` on.
    template <bool all_lit>
    HWY_INLINE cells::Colors columns(std::size_t x) const {
        cells::Colors sum{hn::Zero(F()), hn::Zero(F()), hn::Zero(F())};
        for (std::size_t y = 0; y < 4; ++y) {
            const std::uint32_t* at = radiance_ + y * mask_side + x;
            const auto packed = all_lit ? hn::LoadU(cells::U(), at)
                                        : hn::MaskedLoad(cells::lanes_of(lit_[y], x), cells::U(), at);
            sum = cells::add_unpacked(packed, sum);
        }
        return sum;
    }

    static HWY_INLINE cells::Colors add_pairs(const cells::Colors& low, const cells::Colors& high) {
        return {cells::sum_pairs(low.r, high.r), cells::sum_pairs(low.g, high.g),
                cells::sum_pairs(low.b, high.b)};
    }

    const std::uint32_t* radiance_;  // of the first bit
    const MaskRow* lit_;             // four rows
};

template <bool Stretched>
HWY_INLINE void reflect_tiles_as(const ReceiverBsdf& bsdf, const Directions& directions,
                                 std::span<const std::uint32_t> radiance, const Mask& lit, Spectrum& out) {
    const F f;
    const Prepared prepared(bsdf);
    constexpr std::size_t side = mask_side / 4;
    const int half_width = static_cast<int>(2 * hn::Lanes(f));  // bits
    Spectrums sum{hn::Zero(f), hn::Zero(f), hn::Zero(f)};
    for (std::size_t y = 0; y < side; ++y) {
        const MaskRow* rows = &lit.rows[4 * y];
        const MaskRow any = (rows[0] | rows[1]) | (rows[2] | rows[3]),
                      all = (rows[0] & rows[1]) & (rows[2] & rows[3]);
        const TileRow tiles(&radiance[4 * y * mask_side], rows);
        for (std::size_t x = 0; x < side; x += hn::Lanes(f)) {
            const int column = static_cast<int>(4 * x);
            const auto lit_bits = [&](const MaskRow& row, int from) { return row.bits(from, half_width); };
            if ((lit_bits(any, column) | lit_bits(any, column + half_width)) == 0) continue;
            const std::size_t at = y * side + x;
            const Spectrums s = above_horizon<Stretched>(
                prepared, {hn::LoadU(f, &directions.x[at]), hn::LoadU(f, &directions.y[at]),
                           hn::LoadU(f, &directions.z[at])});
            const bool all_lit =
                (lit_bits(all, column) & lit_bits(all, column + half_width)) == lit_bits(~MaskRow{}, 0);
            const cells::Colors light = all_lit ? tiles.tiles<true>(4 * x) : tiles.tiles<false>(4 * x);
            sum = {hn::MulAdd(light.r, s.r, sum.r), hn::MulAdd(light.g, s.g, sum.g),
                   hn::MulAdd(light.b, s.b, sum.b)};
        }
    }
    out = {hn::GetLane(hn::SumOfLanes(f, sum.r)), hn::GetLane(hn::SumOfLanes(f, sum.g)),
           hn::GetLane(hn::SumOfLanes(f, sum.b))};
}

void evaluate_some_cells(const ReceiverBsdf& bsdf, const Directions& centers, const CellMask& wanted,
                         const SpectrumArrays& out) {
    if (is_anisotropic(bsdf.ggx))
        evaluate_cells_as<true>(bsdf, centers, wanted, out);
    else
        evaluate_cells_as<false>(bsdf, centers, wanted, out);
}

void reflect_all_tiles(const ReceiverBsdf& bsdf, const Directions& directions,
                       std::span<const std::uint32_t> radiance, const Mask& lit, Spectrum& out) {
    if (is_anisotropic(bsdf.ggx))
        reflect_tiles_as<true>(bsdf, directions, radiance, lit, out);
    else
        reflect_tiles_as<false>(bsdf, directions, radiance, lit, out);
}

/// `radiance`: null for 1 everywhere.
template <bool Stretched>
HWY_INLINE void evaluate_tiles_as(const ReceiverBsdf& bsdf, Vec3 normal, const DirectionRuns& points,
                                  const RadianceRuns* radiance, std::size_t per_texel,
                                  std::span<const std::uint32_t> tiles, const SpectrumArrays& out) {
    const F f;
    const Prepared prepared(bsdf);
    const VF share = constant(1 / static_cast<float>(per_texel));
    for (std::size_t k = 0; k < tiles.size(); ++k)
        for (std::size_t lane = 0; lane < 16; lane += hn::Lanes(f)) {
            VF r = hn::Zero(f), g = hn::Zero(f), b = hn::Zero(f);
            for (std::size_t run = tiles[k] * per_texel; run < (tiles[k] + 1) * per_texel; ++run) {
                const std::size_t at = 16 * run + lane;
                const Vec3s w{hn::LoadU(f, &points.x[at]), hn::LoadU(f, &points.y[at]),
                              hn::LoadU(f, &points.z[at])};
                const VF factor = hn::IfThenElseZero(hn::Gt(dot(w, normal), hn::Zero(f)), share);
                const Spectrums s = above_horizon<Stretched>(prepared, w);
                r = hn::MulAdd(s.r, radiance ? hn::Mul(factor, hn::LoadU(f, &radiance->r[at])) : factor, r);
                g = hn::MulAdd(s.g, radiance ? hn::Mul(factor, hn::LoadU(f, &radiance->g[at])) : factor, g);
                b = hn::MulAdd(s.b, radiance ? hn::Mul(factor, hn::LoadU(f, &radiance->b[at])) : factor, b);
            }
            hn::StoreU(r, f, &out.r[16 * k + lane]);
            hn::StoreU(g, f, &out.g[16 * k + lane]);
            hn::StoreU(b, f, &out.b[16 * k + lane]);
        }
}

void evaluate_all_tiles(const ReceiverBsdf& bsdf, Vec3 normal, const DirectionRuns& points,
                        const RadianceRuns* radiance, std::size_t per_texel,
                        std::span<const std::uint32_t> tiles, const SpectrumArrays& out) {
    if (is_anisotropic(bsdf.ggx))
        evaluate_tiles_as<true>(bsdf, normal, points, radiance, per_texel, tiles, out);
    else
        evaluate_tiles_as<false>(bsdf, normal, points, radiance, per_texel, tiles, out);
}

}  // namespace
}  // namespace relumine::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace relumine {

HWY_EXPORT(evaluate_all);
HWY_EXPORT(evaluate_some_cells);
HWY_EXPORT(evaluate_all_tiles);
HWY_EXPORT(reflect_all_tiles);

void evaluate(const ReceiverBsdf& bsdf, const Directions& w_in, const SpectrumArrays& out) {
    HWY_DYNAMIC_DISPATCH(evaluate_all)(bsdf, w_in, out);
}

void evaluate_cells(const ReceiverBsdf& bsdf, const Directions& centers, const CellMask& cells,
                    const SpectrumArrays& out) {
    HWY_DYNAMIC_DISPATCH(evaluate_some_cells)(bsdf, centers, cells, out);
}

Spectrum reflect_tiles(const ReceiverBsdf& bsdf, const Directions& directions,
                       std::span<const std::uint32_t> radiance, const Mask& lit) {
    Spectrum sum;
    HWY_DYNAMIC_DISPATCH(reflect_all_tiles)(bsdf, directions, radiance, lit, sum);
    return sum;
}

void evaluate_tiles(const ReceiverBsdf& bsdf, Vec3 normal, const DirectionRuns& points, std::size_t per_texel,
                    std::span<const std::uint32_t> tiles, const SpectrumArrays& out) {
    HWY_DYNAMIC_DISPATCH(evaluate_all_tiles)(bsdf, normal, points, nullptr, per_texel, tiles, out);
}

void evaluate_products(const ReceiverBsdf& bsdf, Vec3 normal, const DirectionRuns& points,
                       const RadianceRuns& radiance, std::size_t per_texel,
                       std::span<const std::uint32_t> tiles, const SpectrumArrays& out) {
    HWY_DYNAMIC_DISPATCH(evaluate_all_tiles)(bsdf, normal, points, &radiance, per_texel, tiles, out);
}

}  // namespace relumine
#endif
