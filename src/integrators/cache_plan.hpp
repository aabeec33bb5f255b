// SPDX-License-Identifier: Apache-2.0
// What the wanted error means for the steps of `cache`.
#pragma once

#include "blocks/block_partition.hpp"
#include "integrators/residual_rays.hpp"
#include "relumine/render.hpp"

namespace relumine {

struct CachePlan {
    BlockSettings blocks;
    RayBudget rays;
    std::size_t reprojected = 0;  // records around that a map is filled with, beside its own
    bool exact = false, filters = false;
};

/// At an error of 2 %: blocks with a parallax error of a fifth, for each pixel 8 residual rays and 16 shadow
/// rays; in proportion and against it. Set by hand on four scenes, not calibrated.
[[nodiscard]] CachePlan cache_plan(const RenderSettings& settings);

/// One map per block of 8 × 8 pixels and surface, and nothing else: what maps are worth without more.
[[nodiscard]] CachePlan block_gather_plan(const RenderSettings& settings);

}  // namespace relumine
