// SPDX-License-Identifier: Apache-2.0
// What the elements of a radiance field see: links to other elements, and light.
#pragma once

#include "radiance/bright_cones.hpp"
#include "radiance/field_rays.hpp"

namespace relumine {

/// Where a ray's light comes from a surface that reflects diffusely.
struct Landing {
    Vec3 position, normal;  // geometric, on the side that was met
    float offset = 0;
    float distance = 0;   // metres, to the first surface that the ray has met
    Spectrum throughput;  // from the irradiance there, over π, to the radiance of the ray
    Vec3 direction;  // unit: of the ray, turned as the surface where it starts is turned from the element
    std::uint16_t ray = 0;
    std::uint8_t lobes = 0;  // that the ray was reflected along on its way
};

/// What an element's rays have found.
struct ElementView {
    std::vector<Landing> landings;
    std::vector<Sight> sky;      // where the settings want arrivals
    IrradianceVector light;      // what arrives straight from lights, less light samples
    IrradianceVector reflected;  // of lights, along lobes
    IrradianceVector strongest;  // part of it: the most that a single ray found
    std::vector<float> finds;    // luminance that rays found along lobes, where that is any
};

/// Traces `count` rays over the hemispheres of `points`.
[[nodiscard]] ElementView trace_element(const Transport& t, Vec3 normal, std::span<const StartPoint> points,
                                        ElementId id, int count, const FieldSettings& settings,
                                        RayCounts& rays);

/// Rays towards bright elements besides: what cosine-distributed rays seldom meet. The two are weighed by the
/// balance heuristic [Veach97].
struct GuidedView {
    std::vector<float> share;       // by ray of trace_element: its weight, now that there are others
    std::vector<Landing> landings;  // of the others, weighed; their rays count from settings.rays on
};
[[nodiscard]] GuidedView guide_element(const Transport& t, Vec3 normal, std::span<const StartPoint> points,
                                       const BrightCones& cones, ElementId id, int count,
                                       const FieldSettings& settings, RayCounts& rays);

}  // namespace relumine
