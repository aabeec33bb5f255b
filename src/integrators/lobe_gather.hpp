// SPDX-License-Identifier: Apache-2.0
// What records of the rival methods do not hold and each camera sample draws for itself: glossy lobes and the
// bright part of the light.
#pragma once

#include "blocks/bright_split.hpp"
#include "integrators/shading_point.hpp"
#include "radiance/incident.hpp"
#include "relumine/render.hpp"

namespace relumine {

/// Rays along lobes and shadow rays to bright light, weighed against each other where both can find the same.
class LobeGather {
  public:
    LobeGather(const RenderSettings& settings, const IncidentRadiance& source, const BrightSplit& split);

    /// What `lobes`, a part of the point's BSDF, reflect of all light but what comes from point, spot and
    /// directional lights; of the bright light the share that bright() leaves to them.
    [[nodiscard]] SplitRadiance gathered(const ShadingPoint& x, const Bsdf& lobes, const SampleStream& stream,
                                         RayCounts& counts) const;

    /// What the whole BSDF reflects of the bright light; `lobes` as above, null where gathered() is not asked
    /// for any.
    [[nodiscard]] Spectrum bright(const ShadingPoint& x, const Bsdf* lobes, const SampleStream& stream,
                                  RayCounts& counts) const;

  private:
    struct LobeRay {
        Spectrum weight;  // f·|cos θ| / pdf
        float pdf = 0;
    };
    [[nodiscard]] static Ray sample_ray(const ShadingPoint& x, const Bsdf& lobes, const SampleStream& stream,
                                        LobeRay& ray);

    const IncidentRadiance& source_;
    const BrightSplit& split_;
    std::uint32_t rays_, light_samples_;
};

}  // namespace relumine
