// SPDX-License-Identifier: Apache-2.0
// Inversion of the cumulative distribution: the row, then the column within it.
#include "cache/product_distribution.hpp"

#include <algorithm>

#include "cache/hemisphere_map.hpp"

namespace relumine {
namespace {

constexpr std::size_t sums_per_row = cell_side + 1;

struct Inversion {
    int index;       // of the interval
    float fraction;  // of the way through it, in [0, 1)
};

/// The interval of the partial sums that holds u × the last sum; never an empty one.
Inversion invert(std::span<const float> sums, float u) {
    const float target = u * sums.back();
    auto above = std::upper_bound(sums.begin(), sums.end(), target);
    if (above == sums.end())
        above = std::lower_bound(sums.begin(), sums.end(), sums.back());  // u rounded up to 1
    const auto i = static_cast<std::size_t>(above - sums.begin()) - 1;
    const float fraction = (target - sums[i]) / (sums[i + 1] - sums[i]);
    return {static_cast<int>(i), std::clamp(fraction, 0.0f, 0x1.fffffep-1f)};
}

}  // namespace

void ProductDistribution::build(std::span<const float> weights) {
    weights_.assign(weights.begin(), weights.end());
    columns_.resize(cell_side * sums_per_row);
    rows_.assign(1, 0.0f);
    for (std::size_t y = 0; y < cell_side; ++y) {
        float* sums = &columns_[y * sums_per_row];
        sums[0] = 0;
        for (std::size_t x = 0; x < cell_side; ++x) sums[x + 1] = sums[x] + weights_[y * cell_side + x];
        rows_.push_back(rows_.back() + sums[cell_side]);
    }
    total_ = rows_.back();
}

DirectionSample ProductDistribution::sample(Point2 u) const {
    const Inversion row = invert(rows_, u.y);
    const std::span<const float> sums(&columns_[static_cast<std::size_t>(row.index) * sums_per_row],
                                      sums_per_row);
    const Inversion column = invert(sums, u.x);
    const auto along = [](const Inversion& i) {
        return (static_cast<float>(i.index) + i.fraction) / cell_side;
    };
    return {square_to_hemisphere({along(column), along(row)}), cell_pdf(column.index, row.index)};
}

float ProductDistribution::pdf(LocalDir w_in) const {
    if (w_in.v.z <= 0) return 0;
    const Point2 p = hemisphere_to_square(w_in);
    const auto cell = [](float along) {
        return std::clamp(static_cast<int>(along * cell_side), 0, cell_side - 1);
    };
    return cell_pdf(cell(p.x), cell(p.y));
}

float ProductDistribution::cell_pdf(int x, int y) const {
    return weights_[static_cast<std::size_t>(y * cell_side + x)] / (total_ * cell_solid_angle);
}

}  // namespace relumine
