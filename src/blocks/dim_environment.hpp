// SPDX-License-Identifier: Apache-2.0
// The dim part of the environment, averaged over every texel of the grid and of finer ones: what a texel with
// a free view holds, and what of it a sharp lobe resolves.
#pragma once

#include "blocks/bright_split.hpp"
#include "blocks/quadrature_points.hpp"

namespace relumine {

/// Black without an environment.
struct DimEnvironment {
    DimEnvironment(const Transport& t, const BrightSplit& split, const DirectionGrid& grid, int threads);

    std::vector<Spectrum> texels;                        // of the grid: means
    std::array<RadianceRuns, fine_tiers.size()> points;  // means around the points of the fine tiers
    float luminance = 0;                                 // mean over the sphere
};

}  // namespace relumine
