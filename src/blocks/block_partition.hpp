// SPDX-License-Identifier: Apache-2.0
// Which camera samples share a map.
#pragma once

#include <limits>

#include "blocks/block_trace.hpp"
#include "cache/placement.hpp"
#include "cache/receiver_bsdf.hpp"

namespace relumine {

/// Pixels along each side of the cells that blocks are parts of; cells are anchored at pixel (0, 0).
inline constexpr int cell_pixels = 16;

/// A camera sample that may share a map.
struct BlockPoint {
    const CachePoint* point;
    ReceiverBsdf bsdf;  // world space
};

struct BlockSettings {
    int largest = 16, smallest = 4;  // pixels along a block's side; powers of two, largest ≤ cell_pixels
    float tolerance = 0.05f;  // of the parallax error that makes a block split, relative to what is reflected
    float rays_per_pixel = 24;  // that small groups are worth
    float most_rays = 10000;    // that any group is: records around add to a map, and many blocks are divided
    float level = 0;            // radiance that errors are relative to where there is less
    float min_cos_normals = 0.9f;  // between the anchor's geometric normal and the other samples'
    int samples_per_pixel = 1;     // of those that share maps
    /// Bytes that a cell's records and maps may take. Where that is little, blocks are not divided; where it
    /// is less, groups have neither record nor map.
    double most_bytes = std::numeric_limits<double>::infinity();
    double map_weight = 1;  // what a map's bytes count for there, beside a record's
};

/// The records of a cell: its samples in groups of similar position and normal, in blocks as large as the
/// parallax of what they see allows. Blocks that were too large leave a record, too, of which no map is to be
/// made. A function of the cell's samples alone.
[[nodiscard]] std::vector<MapRecord> make_records(const MapSource& source, const PixelRect& cell,
                                                  std::span<const BlockPoint> points,
                                                  const BlockSettings& settings, RayCounts& rays);

}  // namespace relumine
