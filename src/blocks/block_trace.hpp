// SPDX-License-Identifier: Apache-2.0
// Filling a block map by tracing rays through its texels.
#pragma once

#include "blocks/block_map.hpp"
#include "blocks/dim_environment.hpp"
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

/// Fills `map` with what is seen from `starts`, of which the first is its anchor: a ray starts there unless
/// its direction lies below that point's horizon; then where it stands highest. Texels that no start sees
/// stay unknown. A function of its arguments alone; `key` decides where in their texels rays go. `distances`
/// receives, by texel, how far what is seen is, metres. Adds rays of RayPurpose::record.
void trace_map(const MapSource& source, std::span<const GatherPoint> starts, const TileRays& tile_rays,
               std::uint64_t key, BlockMap& map, std::vector<float>& distances, RayCounts& rays);

}  // namespace relumine
