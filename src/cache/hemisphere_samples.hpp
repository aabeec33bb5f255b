// SPDX-License-Identifier: Apache-2.0
// The first step of a record: n × n stratified rays over the hemisphere of a point [V, §3.2].
#pragma once

#include <vector>

#include "radiance/incident.hpp"

namespace relumine {

/// What the ray through one texel has found.
struct TexelSample {
    Spectrum radiance, direct;  // incident; `direct` is the part that comes straight from lights
    float distance = infinity;  // metres; infinite at a miss
    Vec3 offset;  // of the hit from the record's position, world space; at a miss the unit direction
    Vec3 normal;  // geometric, unit, towards the record; 0 at a miss
};

/// Where the rays start.
struct GatherPoint {
    Vec3 position;
    Frame frame;              // n: geometric normal on the viewer's side
    float offset = 0;         // metres along the normal that clear rounding errors
    std::uint32_t depth = 0;  // scattering vertices before the point
};

/// side × side texels, row-major in (v, u); one ray in each, jittered by a hash of `key`. Adds rays of
/// RayPurpose::record. side is a multiple of 4.
[[nodiscard]] std::vector<TexelSample> trace_hemisphere(const IncidentRadiance& source,
                                                        const GatherPoint& point, int side, std::uint64_t key,
                                                        RayCounts& rays);

}  // namespace relumine
