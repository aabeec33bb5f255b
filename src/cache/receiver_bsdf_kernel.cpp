// SPDX-License-Identifier: Apache-2.0
// The BSDF kernel: arrays of directions, cells and tiles.
#include "cache/receiver_bsdf.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "cache/receiver_bsdf_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "cache/cells-inl.hpp"
#include "cache/receiver_bsdf-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace relumine::HWY_NAMESPACE {
namespace {

template <Shape shape>
HWY_INLINE void evaluate_as(const ReceiverBsdf& bsdf, const Directions& w_in, const SpectrumArrays& out) {
    const F f;
    const Prepared<shape> prepared(bsdf);
    const std::size_t lanes = hn::Lanes(f), count = w_in.x.size(), whole = count / lanes * lanes;
    std::size_t i = 0;
    for (; i < whole; i += lanes) {
        const Spectrums s = above_horizon(
            prepared, {hn::LoadU(f, &w_in.x[i]), hn::LoadU(f, &w_in.y[i]), hn::LoadU(f, &w_in.z[i])});
        hn::StoreU(s.r, f, &out.r[i]);
        hn::StoreU(s.g, f, &out.g[i]);
        hn::StoreU(s.b, f, &out.b[i]);
    }
    for (; i < count; ++i) {
        const Spectrums s =
            above_horizon(prepared, {constant(w_in.x[i]), constant(w_in.y[i]), constant(w_in.z[i])});
        out.r[i] = hn::GetLane(s.r);
        out.g[i] = hn::GetLane(s.g);
        out.b[i] = hn::GetLane(s.b);
    }
}

void evaluate_all(const ReceiverBsdf& bsdf, const Directions& w_in, const SpectrumArrays& out) {
    switch (shape_of(bsdf)) {
        case Shape::round:
            return evaluate_as<Shape::round>(bsdf, w_in, out);
        case Shape::stretched:
            return evaluate_as<Shape::stretched>(bsdf, w_in, out);
        case Shape::layered:
            return evaluate_as<Shape::layered>(bsdf, w_in, out);
    }
}

template <Shape shape>
HWY_INLINE void evaluate_cells_as(const ReceiverBsdf& bsdf, const Directions& centers, const CellMask& wanted,
                                  const SpectrumArrays& out) {
    const F f;
    const Prepared<shape> prepared(bsdf);
    constexpr std::size_t side = mask_side / 2;
    for (std::size_t y = 0; y < side; ++y)
        for (std::size_t x = 0; x < side; x += hn::Lanes(f)) {
            if (!cells::any_in_lanes(wanted[y], x)) continue;
            const std::size_t at = y * side + x;
            const Spectrums s = above_horizon(
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

template <Shape shape>
HWY_INLINE void reflect_tiles_as(const ReceiverBsdf& bsdf, const Directions& directions,
                                 std::span<const std::uint32_t> radiance, const Mask& lit, Spectrum& out) {
    const F f;
    const Prepared<shape> prepared(bsdf);
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
            const Spectrums s =
                above_horizon(prepared, {hn::LoadU(f, &directions.x[at]), hn::LoadU(f, &directions.y[at]),
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
    switch (shape_of(bsdf)) {
        case Shape::round:
            return evaluate_cells_as<Shape::round>(bsdf, centers, wanted, out);
        case Shape::stretched:
            return evaluate_cells_as<Shape::stretched>(bsdf, centers, wanted, out);
        case Shape::layered:
            return evaluate_cells_as<Shape::layered>(bsdf, centers, wanted, out);
    }
}

void reflect_all_tiles(const ReceiverBsdf& bsdf, const Directions& directions,
                       std::span<const std::uint32_t> radiance, const Mask& lit, Spectrum& out) {
    switch (shape_of(bsdf)) {
        case Shape::round:
            return reflect_tiles_as<Shape::round>(bsdf, directions, radiance, lit, out);
        case Shape::stretched:
            return reflect_tiles_as<Shape::stretched>(bsdf, directions, radiance, lit, out);
        case Shape::layered:
            return reflect_tiles_as<Shape::layered>(bsdf, directions, radiance, lit, out);
    }
}

/// `radiance`: null for 1 everywhere.
template <Shape shape>
HWY_INLINE void evaluate_tiles_as(const ReceiverBsdf& bsdf, Vec3 normal, const DirectionRuns& points,
                                  const RadianceRuns* radiance, std::size_t per_texel,
                                  std::span<const std::uint32_t> tiles, const SpectrumArrays& out) {
    const F f;
    const Prepared<shape> prepared(bsdf);
    const VF share = constant(1 / static_cast<float>(per_texel));
    for (std::size_t k = 0; k < tiles.size(); ++k)
        for (std::size_t lane = 0; lane < 16; lane += hn::Lanes(f)) {
            VF r = hn::Zero(f), g = hn::Zero(f), b = hn::Zero(f);
            for (std::size_t run = tiles[k] * per_texel; run < (tiles[k] + 1) * per_texel; ++run) {
                const std::size_t at = 16 * run + lane;
                const Vec3s w{hn::LoadU(f, &points.x[at]), hn::LoadU(f, &points.y[at]),
                              hn::LoadU(f, &points.z[at])};
                const VF factor = hn::IfThenElseZero(hn::Gt(dot(w, normal), hn::Zero(f)), share);
                const Spectrums s = above_horizon(prepared, w);
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
    switch (shape_of(bsdf)) {
        case Shape::round:
            return evaluate_tiles_as<Shape::round>(bsdf, normal, points, radiance, per_texel, tiles, out);
        case Shape::stretched:
            return evaluate_tiles_as<Shape::stretched>(bsdf, normal, points, radiance, per_texel, tiles, out);
        case Shape::layered:
            return evaluate_tiles_as<Shape::layered>(bsdf, normal, points, radiance, per_texel, tiles, out);
    }
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
