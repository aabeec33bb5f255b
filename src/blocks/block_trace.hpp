// SPDX-License-Identifier: Apache-2.0
// Making a record by tracing rays through the texels of the world's grid.
#pragma once

#include "blocks/bright_split.hpp"
#include "blocks/dim_environment.hpp"
#include "blocks/map_record.hpp"
#include "radiance/incident.hpp"

namespace relumine {

/// What all block maps of a picture are traced with.
struct MapSource {
    const IncidentRadiance& radiance;
    const BrightSplit& split;
    const DirectionGrid& grid;
    const DimEnvironment& environment;
};

/// Rays through a tile, each of which stands for its share of the texels: 0 (below all horizons), 1, 4 or 16.
using TileRays = std::vector<std::uint8_t>;

/// Fills `record` with what is seen from `starts`, of which the first is its anchor: a ray starts there
/// unless its direction lies below that point's horizon; then where it stands highest. Directions that no
/// start sees have no ray. A function of its arguments alone; `key` decides where in their texels rays go.
/// Adds rays of RayPurpose::record.
void trace_record(const MapSource& source, std::span<const GatherPoint> starts, const TileRays& tile_rays,
                  std::uint64_t key, MapRecord& record, RayCounts& rays);

}  // namespace relumine
