// SPDX-License-Identifier: Apache-2.0
// Filling what reprojection has left open: one ray per cell of k × k bits that has gaps [V, §3.3].
#pragma once

#include "cache/hemisphere_samples.hpp"
#include "cache/reproject.hpp"

namespace relumine {

/// A gap ray: through a random one of the open bits of its cell, for all of them.
struct GapRay {
    std::uint8_t x = 0, y = 0;            // the bit
    std::uint8_t cell_x = 0, cell_y = 0;  // the cell's first bit
    std::uint8_t bits =
        0;  // how many open bits it stands for: its weight is bits/k² of the cell's solid angle
};

/// The rays that fill the gaps of `covered`, cells in row-major order; each bit is drawn uniformly among the
/// open ones of its cell. `k` is 1, 2, 4 or 8; `key` decides.
void choose_gap_rays(const Mask& covered, int k, std::uint64_t key, std::vector<GapRay>& rays);

/// Gives every open bit the radiance that its cell's ray brings back; all bits are covered after.
/// `point.frame` is the receiver's. Adds rays of RayPurpose::gap. `rays` is scratch.
void fill_gaps(const IncidentRadiance& source, const GatherPoint& point, int k, std::uint64_t key,
               Reprojection& incident, std::vector<GapRay>& rays, RayCounts& counts);

}  // namespace relumine
