// SPDX-License-Identifier: Apache-2.0
// Where in and around a pixel its samples lie: filters by importance sampling, so that pixels stay
// independent of each other.
#pragma once

#include <array>

#include "base/vec.hpp"

namespace relumine {

enum class PixelFilterKind {
    center /* no filter: the pixel's centre */,
    box /* the pixel's area */,
    blackman_harris /* 3 pixels wide */
};

/// Draws positions with a density proportional to the filter; every sample then weighs the same [Ernst06].
class PixelFilter {
  public:
    explicit PixelFilter(PixelFilterKind kind);

    /// A position relative to the pixel's top left corner; `u` in [0, 1)².
    [[nodiscard]] Point2 position(Point2 u) const;

  private:
    [[nodiscard]] float offset(float u) const;

    static constexpr std::size_t steps = 256;
    PixelFilterKind kind_;
    std::array<float, steps + 1> cdf_{};  // of the Blackman-Harris window over [−1.5, 1.5]
};

}  // namespace relumine
