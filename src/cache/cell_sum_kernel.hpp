// SPDX-License-Identifier: Apache-2.0
// Sums packed radiance over cells of 2 × 2 bits and weighs it by cell; finds cells where weights curve.
#pragma once

#include <span>
#include <vector>

#include "base/vec.hpp"
#include "cache/mask.hpp"

namespace relumine {

struct CellWeights {
    std::span<const float> r, g, b;
};

/// Σ over cells of weight × Σ over the cell's lit bits of radiance. `radiance`: mask_side², RGBE; `weights`:
/// (mask_side/2)² each. Where `products` is not empty it receives the luminance of each cell's term.
[[nodiscard]] Spectrum sum_cells(std::span<const std::uint32_t> radiance, const Mask& lit,
                                 const CellWeights& weights, std::span<float> products);

/// Appends those of `cells`, but for those at the square's border, where |second differences| of `values`
/// along both axes exceed `share` × (value + mean of `cells`), in ascending order. `values`: (mask_side/2)²;
/// what is neither in `cells` nor beside one of them does not matter.
void find_curved_cells(std::span<const float> values, const CellMask& cells, float share,
                       std::vector<std::uint32_t>& found);

}  // namespace relumine
