// SPDX-License-Identifier: Apache-2.0
// Reprojection of a record: where its points are as seen from another place. The world's axes are those of
// all maps, so this is a subtraction.
#pragma once

#include "blocks/map_record.hpp"

namespace relumine {

/// By point of a record, and some more as it is padded.
struct ProjectedPoints {
    std::vector<std::uint32_t> texels;
    std::vector<float> distances2;  // metres², from the eye
};

/// Projects the points of `record` onto the grid as `eye` sees them.
void project_points(const DirectionGrid& grid, const MapRecord& record, Vec3 eye, ProjectedPoints& out);

}  // namespace relumine
