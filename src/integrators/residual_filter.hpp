// SPDX-License-Identifier: Apache-2.0
// Smoothing what few rays have estimated, along surfaces: the edge-avoiding à-trous wavelet [Dammertz10].
#pragma once

#include <cstdint>
#include <vector>

#include "base/frame.hpp"

namespace relumine {

/// What a pixel shows, for telling surfaces apart.
struct FilterGuide {
    Vec3 position, normal;
    float footprint = 0;  // metres that a pixel covers; 0: nothing to filter here
};

/// A picture under the filter, row-major.
struct FilterImage {
    int width = 0, height = 0;
    std::vector<FilterGuide> guides;
    std::vector<Spectrum> values;
};

/// How far a filter of so many levels reaches, pixels.
constexpr int filter_reach(int levels) { return 2 * ((1 << levels) - 1); }

/// Replaces every value by a mean over its surroundings on the same surface, up to filter_reach(levels)
/// away.
void filter_along_surfaces(FilterImage& image, int levels, int threads);

}  // namespace relumine
