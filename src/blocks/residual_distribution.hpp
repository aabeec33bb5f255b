// SPDX-License-Identifier: Apache-2.0
// Where the true integrand is expected to differ from the one in the maps: a density for residual rays.
#pragma once

#include <optional>

#include "blocks/map_integral.hpp"

namespace relumine {

struct ResidualSample {
    WorldDir direction;
    std::uint32_t texel = 0;
    float pdf = 0;  // per steradian
};

/// A density over the sphere in proportion to MapIntegral::deviations(), constant within texels. Drawing
/// warps the unit square quarter by quarter, so that well spread points stay well spread.
class ResidualDistribution {
  public:
    explicit ResidualDistribution(const DirectionGrid& grid);

    /// `integral` must stay as it is while samples are drawn.
    void build(const MapIntegral& integral);

    /// Whether no deviation is expected at all: nothing can be drawn.
    [[nodiscard]] bool empty() const { return !(levels_.back()[0] > 0); }
    [[nodiscard]] ResidualSample sample(Point2 u) const;
    /// 1/sr; 0 where `sample` never goes.
    [[nodiscard]] float pdf(std::uint32_t texel) const;

  private:
    const MapIntegral* integral_ = nullptr;
    const DirectionGrid& grid_;
    std::vector<std::vector<float>> levels_;  // sums over squares of tiles, from single tiles to all of them
};

}  // namespace relumine
