// SPDX-License-Identifier: Apache-2.0
// The light on a cell's camera samples: of lights without size, from the maps around, and what is sampled
// beside these.
#pragma once

#include "integrators/cell_rows.hpp"
#include "integrators/gather_estimate.hpp"
#include "integrators/lit_sample.hpp"

namespace relumine {

struct CellLightSource {
    const Transport& transport;
    const GatherEstimate& monte_carlo;  // where there is no map
    ResidualSettings residual;
    const DirectionGrid& grid;
    const QuadraturePoints& points;
    const CachePlan& plan;
    bool estimates_noise;
};

/// Lights the samples of `rect`, part of a cell of `row`, by `maps`. What transmits is left out. Numbers of
/// rays follow the error that each pixel expects (RayDemand); nothing that a pixel's own rays find counts for
/// it.
[[nodiscard]] LitCell light_cell(const CellLightSource& source, const CellRow& row, const PixelRect& rect,
                                 std::span<const BlockMap* const> maps, RayCounts& rays, CacheCounts& counts);

}  // namespace relumine
