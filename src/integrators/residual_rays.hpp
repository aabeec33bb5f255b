// SPDX-License-Identifier: Apache-2.0
// What maps leave to be sampled: their own error, and the bright part of the light.
#pragma once

#include "blocks/bright_split.hpp"
#include "blocks/residual_distribution.hpp"
#include "integrators/shading_point.hpp"
#include "radiance/incident.hpp"

namespace relumine {

/// Rays that a camera sample gets on average.
struct RayBudget {
    float residual = 0, light = 0;
};

/// What is added to MapIntegral::reflected().
struct SampledRadiance {
    MapRadiance residual;  // true dim radiance less what the maps hold
    Spectrum bright;
};

/// What residual rays are drawn and judged with.
struct ResidualSettings {
    const IncidentRadiance& source;
    const BrightSplit& split;
    const DimEnvironment& environment;
    RayBudget budget;
    bool exact;  // integrals are; if not, rays that miss bring back the environment's mean over their texel,
                 // because the maps hold the same: only what is seen is estimated, not the environment's
                 // detail
};

/// A camera sample with the integral that stands for it.
struct IntegratedPoint {
    const ShadingPoint& x;
    const SampleStream& stream;
    const MapIntegral& integral;
    const ResidualDistribution& distribution;  // of `integral`
    Spectrum scale;                            // the point's integral is so many times `integral`
};

/// Estimates the difference between the light that points reflect and their map integrals. With residual rays
/// and exact integrals the estimates are unbiased, whatever the maps hold. Rays of several points are traced
/// together.
class ResidualEstimator {
  public:
    ResidualEstimator(const ResidualSettings& settings, RayCounts& counts)
        : settings_(settings), counts_(counts) {}

    /// Draws the rays of a point; `sum` has all that they find after finish().
    void add(const IntegratedPoint& point, SampledRadiance& sum);
    void finish();

  private:
    struct ResidualRay {
        SampledRadiance* sum = nullptr;
        std::uint32_t texel = 0;
        Spectrum bsdf;           // f·|cos θ|; black where the surface is in the way
        MapRadiance held;        // the integrand in the maps
        float density = 0;       // of residual rays, times how many there are
        float bsdf_density = 0;  // of those drawn from the BSDF, likewise; 0 if this is none of them
    };
    struct LightRay {
        SampledRadiance* sum = nullptr;
        Spectrum reflected;  // where nothing is in the way
    };
    struct Drawn {
        WorldDir direction;
        std::uint32_t texel;
        bool from_bsdf;
    };

    void add_residual(const IntegratedPoint& point, const SampleStream& stream, SampledRadiance& sum);
    void add_light(const IntegratedPoint& point, const SampleStream& stream, SampledRadiance& sum);
    [[nodiscard]] static std::optional<Drawn> draw(const IntegratedPoint& point, const SampleStream& stream);
    void trace_residual();
    void collect(const ResidualRay& drawn, const Ray& ray, const Hit& hit, const SplitRadiance& found) const;
    void trace_light();

    const ResidualSettings& settings_;
    RayCounts& counts_;
    std::array<Ray, packet_size> residual_rays_, light_rays_;
    std::array<ResidualRay, packet_size> residual_;
    std::array<LightRay, packet_size> light_;
    StreamPacket residual_streams_;
    std::size_t residual_count_ = 0, light_count_ = 0;
    std::uint32_t depth_ = 0;  // of the points whose residual rays wait
};

}  // namespace relumine
