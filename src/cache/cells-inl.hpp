// SPDX-License-Identifier: Apache-2.0
// Cells of 2 × 2 bits of packed radiance, for kernels: include after hwy/highway.h; once per instruction set.
#if defined(RELUMINE_CACHE_CELLS_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef RELUMINE_CACHE_CELLS_INL_HPP
#undef RELUMINE_CACHE_CELLS_INL_HPP
#else
#define RELUMINE_CACHE_CELLS_INL_HPP
#endif

#include <span>

#include "base/rgbe.hpp"
#include "base/vec.hpp"
#include "cache/mask.hpp"

HWY_BEFORE_NAMESPACE();
namespace relumine {
namespace HWY_NAMESPACE {
namespace {

namespace cells {

namespace hn = hwy::HWY_NAMESPACE;
using F = hn::CappedTag<float, 16>;
using I = hn::Rebind<std::int32_t, F>;
using U = hn::Rebind<std::uint32_t, F>;
using VF = hn::Vec<F>;
using VU = hn::Vec<U>;

struct Colors {
    VF r, g, b;
};

HWY_INLINE Colors add(const Colors& a, const Colors& b) {
    return {hn::Add(a.r, b.r), hn::Add(a.g, b.g), hn::Add(a.b, b.b)};
}
HWY_INLINE Colors multiply(const Colors& a, const Colors& b) {
    return {hn::Mul(a.r, b.r), hn::Mul(a.g, b.g), hn::Mul(a.b, b.b)};
}

/// `sum` and radiance as pack_rgbe packs it: 0, whose unit is some finite number here, or with an exponent of
/// least_rgbe_exponent or more.
HWY_INLINE Colors add_unpacked(VU packed, const Colors& sum) {
    const U u;
    const F f;
    const VF unit = hn::BitCast(f, hn::ShiftLeft<23>(hn::Sub(hn::ShiftRight<24>(packed), hn::Set(u, 9))));
    const VU byte = hn::Set(u, 255);
    const auto add = [&](VU v, VF to) {
        return hn::MulAdd(hn::ConvertTo(f, hn::BitCast(I(), hn::And(v, byte))), unit, to);
    };
    return {add(packed, sum.r), add(hn::ShiftRight<8>(packed), sum.g),
            add(hn::ShiftRight<16>(packed), sum.b)};
}

/// Sums of neighbouring lanes: half of them from `low`, half from `high`.
HWY_INLINE VF sum_pairs(VF low, VF high) {
#if HWY_TARGET == HWY_SCALAR
    return hn::Add(low, high);
#else
    const F f;
    return hn::Add(hn::ConcatEven(f, high, low), hn::ConcatOdd(f, high, low));
#endif
}

/// The bits of Lanes columns of a row of bits or cells; `column` is a multiple of the lanes.
template <typename Row>
HWY_INLINE hn::Mask<U> lanes_of(const Row& row, std::size_t column) {
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(&row) + column / 8;
    if constexpr (hn::MaxLanes(U()) >= 8) return hn::LoadMaskBits(U(), bytes);
    const std::uint64_t bits = *bytes >> column % 8;
    return hn::LoadMaskBits(U(), reinterpret_cast<const std::uint8_t*>(&bits));
}

/// Whether a row of cells has any of Lanes columns.
HWY_INLINE bool any_in_lanes(std::uint64_t cells, std::size_t column) {
    return (cells >> column & ((std::uint64_t{1} << hn::Lanes(U())) - 1)) != 0;
}

/// Lanes cells: the bits of two rows, black where they are not lit.
struct Cells {
    VU above_low, above_high, below_low, below_high;

    HWY_INLINE Cells(std::span<const std::uint32_t> radiance, const Mask& lit, std::size_t y, std::size_t x) {
        const auto load = [&](std::size_t row, std::size_t column) {
            return hn::MaskedLoad(lanes_of(lit.rows[row], column), U(), &radiance[row * mask_side + column]);
        };
        above_low = load(y, x), above_high = load(y, x + hn::Lanes(U()));
        below_low = load(y + 1, x), below_high = load(y + 1, x + hn::Lanes(U()));
    }

    [[nodiscard]] HWY_INLINE Colors sums() const {
        const Colors black{hn::Zero(F()), hn::Zero(F()), hn::Zero(F())};
        const Colors low = add_unpacked(above_low, add_unpacked(below_low, black)),
                     high = add_unpacked(above_high, add_unpacked(below_high, black));
        return {sum_pairs(low.r, high.r), sum_pairs(low.g, high.g), sum_pairs(low.b, high.b)};
    }
};

/// Σ over cells of weight(cell) × Σ over the cell's lit bits of radiance; weights of black cells are not
/// asked for. `weight` gives those of Lanes cells from `cell` on. Where `products` is not empty (a float per
/// cell) it receives the luminance of each cell's term.
template <typename Weight>
HWY_INLINE Spectrum weighted_sum(std::span<const std::uint32_t> radiance, const Mask& lit,
                                 std::span<float> products, const Weight& weight) {
    const F f;
    constexpr std::size_t side = mask_side / 2;
    Colors sum{hn::Zero(f), hn::Zero(f), hn::Zero(f)};
    for (std::size_t y = 0; y < side; ++y)
        for (std::size_t x = 0; x < side; x += hn::Lanes(f)) {
            const std::size_t cell = y * side + x;
            // Much is black where gather rays bring back emission alone.
            const int column = static_cast<int>(2 * x), columns = static_cast<int>(2 * hn::Lanes(f));
            if ((lit.rows[2 * y] | lit.rows[2 * y + 1]).bits(column, columns) == 0) {
                if (!products.empty()) hn::StoreU(hn::Zero(f), f, &products[cell]);
                continue;
            }
            const Colors term = multiply(Cells(radiance, lit, 2 * y, 2 * x).sums(), weight(cell));
            sum = add(sum, term);
            if (products.empty()) continue;
            const VF luminance =
                hn::MulAdd(term.r, hn::Set(f, 0.2126f),
                           hn::MulAdd(term.g, hn::Set(f, 0.7152f), hn::Mul(term.b, hn::Set(f, 0.0722f))));
            hn::StoreU(luminance, f, &products[cell]);
        }
    return {hn::GetLane(hn::SumOfLanes(f, sum.r)), hn::GetLane(hn::SumOfLanes(f, sum.g)),
            hn::GetLane(hn::SumOfLanes(f, sum.b))};
}

}  // namespace cells

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace relumine
HWY_AFTER_NAMESPACE();

#endif
