// SPDX-License-Identifier: Apache-2.0
// Where a camera ray's light is gathered: the first surface that scatters, behind mirrors and smooth glass.
#pragma once

#include "integrators/view.hpp"

namespace relumine {

/// Where a surface seen through mirrors and glass begins to scatter, with what came before it.
struct ShadingPoint {
    PathState path;  // throughput up to here; path.ray has hit here
    Vertex vertex;   // its BSDF without delta lobes
    float distance;  // metres from the camera, along the whole prefix
};

/// What a prefix is made of.
struct PrefixSettings {
    std::uint32_t max_depth;  // scattering vertices of a whole path
    float sharp_alpha = 0;    // surfaces whose lobes all have a GGX α below it belong to it, too
};

/// Follows mirrors and smooth glass, and what is nearly so, from a camera sample to a surface that scatters;
/// adds what they show of light to `emission`: of what is only nearly smooth by sampling lights as well.
/// Empty where the path ends before, or has `max_depth` scattering vertices.
[[nodiscard]] std::optional<ShadingPoint> follow_prefix(const Transport& t, const CameraSample& sample,
                                                        const PrefixSettings& settings, Spectrum& emission,
                                                        RayCounts& rays);

}  // namespace relumine
