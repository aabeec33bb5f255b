// SPDX-License-Identifier: Apache-2.0
// Hierarchical sample warping over the Morton order [Clarberg05].
#include "blocks/residual_distribution.hpp"

namespace relumine {
namespace {

/// Splits [0, 1) between two weights by `u`, which is stretched to [0, 1) again; which one it fell into.
std::uint32_t choose(float first, float second, float& u) {
    const float sum = first + second;
    const float share = sum > 0 ? first / sum : 0.5f;
    const auto rescaled = [](float x) { return std::clamp(x, 0.0f, 0x1.fffffep-1f); };
    if (u < share) {
        u = rescaled(u / share);
        return 0;
    }
    u = rescaled((u - share) / (1 - share));
    return 1;
}

/// One of four squares in Morton order.
std::uint32_t choose_quarter(const float* weights, Point2& u) {
    const std::uint32_t row = choose(weights[0] + weights[1], weights[2] + weights[3], u.y);
    return 2 * row + choose(weights[2 * row], weights[2 * row + 1], u.x);
}

}  // namespace

ResidualDistribution::ResidualDistribution(const DirectionGrid& grid) : grid_(grid) {
    for (std::size_t count = grid.tiles; count >= 1; count /= 4) levels_.emplace_back(count);
}

void ResidualDistribution::build(const MapIntegral& integral) {
    integral_ = &integral;
    std::ranges::copy(integral.deviations(), levels_[0].begin());
    for (std::size_t level = 1; level < levels_.size(); ++level)
        for (std::size_t i = 0; i < levels_[level].size(); ++i) {
            const float* below = &levels_[level - 1][4 * i];
            levels_[level][i] = (below[0] + below[1]) + (below[2] + below[3]);
        }
}

ResidualSample ResidualDistribution::sample(Point2 u) const {
    std::uint32_t at = 0;
    for (std::size_t level = levels_.size() - 1; level-- > 0;)
        at = 4 * at + choose_quarter(&levels_[level][std::size_t{4} * at], u);
    const std::array<float, tile_texels> shares = integral_->texel_shares(at);
    std::array<float, 4> quarters;
    for (std::size_t q = 0; q < 4; ++q)
        quarters[q] = (shares[4 * q] + shares[4 * q + 1]) + (shares[4 * q + 2] + shares[4 * q + 3]);
    const std::uint32_t quarter = choose_quarter(quarters.data(), u);
    at = 16 * at + 4 * quarter + choose_quarter(&shares[std::size_t{4} * quarter], u);
    return {grid_.direction_in(at, u), at, pdf(at)};
}

float ResidualDistribution::pdf(std::uint32_t texel) const {
    const auto tile = texel / static_cast<std::uint32_t>(tile_texels);
    const float weight = levels_[0][tile];
    if (!(weight > 0)) return 0;
    const std::array<float, tile_texels> shares = integral_->texel_shares(tile);
    float sum = 0;
    for (const float share : shares) sum += share;
    return weight / levels_.back()[0] * shares[texel % tile_texels] / (sum * grid_.texel_solid_angle);
}

}  // namespace relumine
