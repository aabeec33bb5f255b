// SPDX-License-Identifier: Apache-2.0
// What rays have found beside the maps, and how far it is to be trusted.
#pragma once

#include "blocks/map_integral.hpp"
#include "integrators/ray_noise.hpp"

namespace relumine {

/// Bright light that a series of rays has found.
struct FoundLight {
    Spectrum radiance, mirrored;  // reflected by all but glossy lobes, and by these
    RayNoise noise, mirrored_noise;
    float rays = 0;  // that the camera sample got on average

    /// Makes one of two series, weighed by their rays, which must not depend on what they have found.
    void join(const FoundLight& other);
};

/// What a series of residual rays has found.
struct FoundResidual {
    MapRadiance dim;  // true radiance less what the maps hold
    RayNoise noise;
    FoundLight bright;

    /// As that of FoundLight.
    void join(const FoundResidual& other);
};

/// What rays towards bright surfaces have found.
struct FoundCones {
    Spectrum indirect;
    RayNoise noise;
};

/// What is added to MapIntegral::reflected().
struct SampledRadiance {
    FoundResidual residual;
    FoundCones cones;
    FoundLight light;

    [[nodiscard]] Spectrum dim_indirect() const { return residual.dim.indirect + cones.indirect; }
};

}  // namespace relumine
