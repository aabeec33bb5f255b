// SPDX-License-Identifier: Apache-2.0
// The bright part of the light: suns, lamps and bright emitters are sampled, the rest is kept in maps.
#pragma once

#include "radiance/bright_cones.hpp"
#include "radiance/transport.hpp"

namespace relumine {

/// Splits what arrives straight from lights into a bright part, which `lights()` samples, and a dim one,
/// which varies little enough for maps. The two always add up to the whole.
class BrightSplit {
  public:
    /// Bright is what exceeds `factor` times the mean radiance of the environment; without one, all emitters.
    /// With a field, emitters that outshine the surfaces are bright as well, and so are its bright elements.
    BrightSplit(const SceneData& scene, float factor, const RadianceField* field = nullptr);

    [[nodiscard]] const LightSampler& lights() const { return lights_; }
    /// Whether there is any.
    [[nodiscard]] bool empty() const { return lights_.empty(); }

    /// A part of the light along a ray and the density with which `lights()` draws that direction.
    struct Part {
        float share = 0;  // bright over all, [0, 1]
        float pdf = 0;    // 1/sr; 0 where nothing is bright
    };
    /// Of the environment's `radiance` along `direction`.
    [[nodiscard]] Part of_environment(WorldDir direction, Spectrum radiance) const;
    /// Of what the surface at `hit` emits along `ray`.
    [[nodiscard]] Part of_emission(const Ray& ray, const Hit& hit) const;
    /// Of a light sample.
    [[nodiscard]] float share(const LightSample& light) const {
        return std::isfinite(light.distance) ? 1 : excess(light.radiance);
    }

    /// Whether what the surface at `hit` reflects is sampled through `cones()`: all of it, then.
    [[nodiscard]] bool reflects_brightly(const Ray& ray, const Hit& hit) const;
    [[nodiscard]] const BrightCones& cones() const;

  private:
    [[nodiscard]] float excess(Spectrum radiance) const;

    const SceneData& scene_;
    const RadianceField* field_;
    float threshold_;
    LightSampler lights_;
};

}  // namespace relumine
