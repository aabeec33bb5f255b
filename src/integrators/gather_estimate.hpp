// SPDX-License-Identifier: Apache-2.0
// The Monte Carlo estimate of the light that a shading point reflects: the paper's baseline [V, §3.4].
#pragma once

#include <memory>

#include "integrators/shading_point.hpp"
#include "radiance/incident.hpp"
#include "relumine/render.hpp"

namespace relumine {

/// n² rays in proportion to the BSDF, stratified, and light samples for the bright part of the light if
/// wanted.
class GatherEstimate {
  public:
    GatherEstimate(const RenderSettings& settings, const Transport& transport, const View& view);

    /// What `x` reflects towards the viewer, without what point, spot and directional lights send there
    /// straight.
    [[nodiscard]] SplitRadiance reflected(const ShadingPoint& x, const SampleStream& stream,
                                          RayCounts& rays) const;

  private:
    struct GatherRay;
    [[nodiscard]] SplitRadiance gather(const ShadingPoint& x, const SampleStream& stream,
                                       RayCounts& rays) const;
    [[nodiscard]] Ray sample_ray(const ShadingPoint& x, GatherRay& ray) const;
    [[nodiscard]] float bsdf_share(const Ray& ray, const Hit& hit, float bsdf_pdf) const;
    [[nodiscard]] Spectrum bright_light(const ShadingPoint& x, const SampleStream& stream,
                                        RayCounts& rays) const;

    const Transport& transport_;
    IncidentRadiance source_;
    std::uint32_t rays_, light_samples_;
    bool packets_;
    Coherence coherence_;                          // stratified rays are sorted by direction
    std::unique_ptr<LightSampler> bright_lights_;  // only with light samples
};

}  // namespace relumine
