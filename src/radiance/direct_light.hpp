// SPDX-License-Identifier: Apache-2.0
// Light that arrives at a vertex straight from a light source, by sampling the lights.
#pragma once

#include "base/ray_counts.hpp"
#include "radiance/path_guide.hpp"

namespace relumine {

/// The ray from `point` to the light sample.
[[nodiscard]] Ray shadow_ray(const SurfacePoint& point, const LightSample& light, std::uint32_t opacity_seed);

/// The share of the sample's light that reaches `point`: 0 in shadow, 1 if nothing is in the way, between
/// behind panes.
[[nodiscard]] Spectrum passed_light(const Transport& t, const SurfacePoint& point, const LightSample& light,
                                    std::uint32_t opacity_seed, RayCounts& rays);

/// Tracer::passed_light of the first `count` lanes, the only ones that are rays.
void passed_light(const Tracer& tracer, const RayLanes& rays, std::size_t count, SpectrumLanes& share);

/// The unshadowed light of a sample that the BSDF sends to the viewer: f·|cos θ|·L, or 0 where the sides
/// disagree.
[[nodiscard]] Spectrum unshadowed(const Vertex& vertex, const LightSample& light);

/// Light that will have been reflected if nothing blocks the ray.
struct LightProposal {
    Ray shadow_ray;
    Spectrum reflected;
    bool delta;  // the light has no size
};

/// What drawing a light takes.
struct LightRandom {
    Point2 point;                // in [0, 1)²
    std::uint32_t opacity_seed;  // of the shadow ray
};

/// One sample of the direct light reflected at `vertex`, weighted against BSDF sampling by the power
/// heuristic, before its shadow ray is traced. Empty where nothing would be reflected. `guide`: what the
/// vertex draws directions from, if that is not its BSDF alone.
[[nodiscard]] std::optional<LightProposal> propose_direct_light(const Transport& t, const Vertex& vertex,
                                                                const LightRandom& u,
                                                                const PathGuide* guide = nullptr);

/// The reflected light of all point, spot and directional lights, a shadow ray each.
[[nodiscard]] Spectrum delta_light(const Transport& t, const Vertex& vertex, std::uint32_t opacity_seed,
                                   RayCounts& rays);

}  // namespace relumine
