// SPDX-License-Identifier: Apache-2.0
// The piecewise constant distribution of reprojected radiance × BSDF × cosine [V, §3.4].
#pragma once

#include <span>
#include <vector>

#include "cache/shade.hpp"

namespace relumine {

struct DirectionSample {
    LocalDir w_in;  // in the receiver's frame
    float pdf = 0;  // per steradian
};

/// A density over the receiver's hemisphere, constant within each cell of the square.
class ProductDistribution {
  public:
    /// `weights`: cell_count, ≥ 0, in proportion to the cells' probabilities.
    void build(std::span<const float> weights);

    /// Whether all weights were 0: nothing can be drawn.
    [[nodiscard]] bool empty() const { return !(total_ > 0); }
    [[nodiscard]] DirectionSample sample(Point2 u) const;
    /// 1/sr; 0 where `sample` never goes.
    [[nodiscard]] float pdf(LocalDir w_in) const;

  private:
    [[nodiscard]] float cell_pdf(int x, int y) const;

    std::vector<float> weights_;  // cell_count
    std::vector<float> columns_;  // per row: cell_side + 1 partial sums
    std::vector<float> rows_;     // cell_side + 1 partial sums
    float total_ = 0;
};

}  // namespace relumine
