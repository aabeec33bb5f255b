// SPDX-License-Identifier: Apache-2.0
// Guided scattering: directions are drawn from the BSDF or from where a radiance field says that light comes
// from, so that a path meets sun on a floor or a window more often than by chance. What the field holds
// decides about noise alone: the density is that of the mixture, whatever it is (the balance heuristic for
// one sample [Veach97, §9.2.4]).
#pragma once

#include "radiance/transport.hpp"

namespace relumine {

class ArrivalMap;

/// What a field knows of the light at a place.
struct PlacedArrivals {
    const ArrivalMap* surfaces = nullptr;  // light that surfaces reflect; null: nothing is known
    const ArrivalMap* sky = nullptr;       // light from infinity that samples of the lights seldom find
    float sky_share = 0;                   // of the samples of the lights that should go there, [0, 1)
    Frame frame;                           // of the maps
};

/// What directions are drawn from at one vertex.
class PathGuide {
  public:
    /// The share of what is reflected diffusely that is drawn from the map.
    static constexpr float usual_share = 0.5f;

    PathGuide(const PlacedArrivals& arrivals, const Vertex& vertex, float share = usual_share);

    /// A direction by the convention of BSDFs: its density is that of the mixture, but of delta lobes, whose
    /// probability it is.
    [[nodiscard]] std::optional<BsdfSample> sample(const Vertex& vertex, BsdfRandom u) const;
    /// Density with which `sample` draws a direction that the BSDF would draw with `bsdf_pdf`, per steradian.
    [[nodiscard]] float pdf(WorldDir direction, float bsdf_pdf) const;

    /// A light as from `lights`, or a part of the sky that the place is known to see.
    [[nodiscard]] std::optional<LightSample> sample_light(const LightSampler& lights, Vec3 from,
                                                          Point2 u) const;
    /// Density with which that draws a light that `lights` draws with `pdf`: light_share() · pdf, and sky_pdf
    /// more where it is the sky.
    [[nodiscard]] float light_share() const { return 1 - arrivals_.sky_share; }
    [[nodiscard]] float sky_pdf(WorldDir direction) const;

  private:
    /// Where maps lead: light may be reflected that way.
    [[nodiscard]] bool is_above(WorldDir direction) const { return dot(direction.v, normal_) > 0; }

    PlacedArrivals arrivals_;
    Vec3 normal_;  // of shading
    float share_;
};

}  // namespace relumine
