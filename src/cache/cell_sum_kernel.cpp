// SPDX-License-Identifier: Apache-2.0
// The kernels that decode, sum and weigh radiance, and find where a table of weights is too coarse.
#include "cache/cell_sum_kernel.hpp"

#include <algorithm>
#include <bit>
#include <numeric>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "cache/cell_sum_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "cache/cells-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace relumine::HWY_NAMESPACE {
namespace {

using namespace cells;

constexpr std::size_t side = mask_side / 2;

void sum_all(std::span<const std::uint32_t> radiance, const Mask& lit, const CellWeights& weights,
             std::span<float> products, Spectrum& out) {
    const F f;
    out = weighted_sum(radiance, lit, products, [&](std::size_t cell) {
        return Colors{hn::LoadU(f, &weights.r[cell]), hn::LoadU(f, &weights.g[cell]),
                      hn::LoadU(f, &weights.b[cell])};
    });
}

/// Column by column, so that the sums do not wait for each other.
float mean(std::span<const float> values, const CellMask& cells) {
    const F f;
    VF sum = hn::Zero(f);
    for (std::size_t x = 0; x < side; x += hn::Lanes(f)) {
        VF column = hn::Zero(f);
        for (std::size_t y = 0; y < side; ++y)
            column = hn::Add(
                column, hn::MaskedLoad(hn::RebindMask(f, lanes_of(cells[y], x)), f, &values[y * side + x]));
        sum = hn::Add(sum, column);
    }
    const int count = std::accumulate(cells.begin(), cells.end(), 0, [](int total, std::uint64_t row) {
        return total + std::popcount(row);
    });
    return hn::GetLane(hn::SumOfLanes(f, sum)) / static_cast<float>(std::max(count, 1));
}

/// |Second differences| along both axes.
HWY_INLINE VF curvature(const float* at, VF value) {
    const F f;
    const VF twice = hn::Add(value, value);
    const auto bend = [&](std::ptrdiff_t step) {
        return hn::Abs(hn::Add(hn::Sub(hn::LoadU(f, at - step), twice), hn::LoadU(f, at + step)));
    };
    return hn::Add(bend(1), bend(side));
}

void find_curved(std::span<const float> values, const CellMask& cells, float share,
                 std::vector<std::uint32_t>& found) {
    const F f;
    const VF limit = hn::Set(f, share), noticeable = hn::Set(f, mean(values, cells));
    constexpr std::uint64_t inner = ~std::uint64_t{0} >> 2 << 1;  // neither the first nor the last column
    for (std::size_t y = 1; y + 1 < side; ++y) {
        std::uint64_t row = 0;
        for (std::size_t x = 0; x < side; x += hn::Lanes(f)) {
            if (!any_in_lanes(cells[y], x)) continue;
            const float* at = &values[y * side + x];
            const VF value = hn::LoadU(f, at);
            const auto curved = hn::Gt(curvature(at, value), hn::Mul(limit, hn::Add(value, noticeable)));
            std::uint64_t bits = 0;
            hn::StoreMaskBits(f, curved, reinterpret_cast<std::uint8_t*>(&bits));
            row |= bits << x;
        }
        for (row &= inner & cells[y]; row != 0; row &= row - 1)
            found.push_back(static_cast<std::uint32_t>(y * side)
                            + static_cast<std::uint32_t>(std::countr_zero(row)));
    }
}

}  // namespace
}  // namespace relumine::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace relumine {

HWY_EXPORT(sum_all);
HWY_EXPORT(find_curved);

Spectrum sum_cells(std::span<const std::uint32_t> radiance, const Mask& lit, const CellWeights& weights,
                   std::span<float> products) {
    Spectrum sum;
    HWY_DYNAMIC_DISPATCH(sum_all)(radiance, lit, weights, products, sum);
    return sum;
}

void find_curved_cells(std::span<const float> values, const CellMask& cells, float share,
                       std::vector<std::uint32_t>& found) {
    HWY_DYNAMIC_DISPATCH(find_curved)(values, cells, share, found);
}

}  // namespace relumine
#endif
