// SPDX-License-Identifier: Apache-2.0
// What maps leave to be sampled: their own error, and the bright part of the light.
#pragma once

#include "blocks/bright_split.hpp"
#include "blocks/residual_distribution.hpp"
#include "integrators/sampled_radiance.hpp"
#include "integrators/shading_point.hpp"
#include "radiance/incident.hpp"
#include "shading/sharp_lobes.hpp"

namespace relumine {

/// Rays that a camera sample gets on average.
struct RayBudget {
    float residual = 0, light = 0;
};

/// Successive series of a point draw other samples.
enum class RaySeries : std::uint8_t { first, second };

/// What residual rays are drawn and judged with.
struct ResidualSettings {
    const IncidentRadiance& source;
    const BrightSplit& split;
    const DimEnvironment& environment;
    RayBudget budget;  // what is usual: it divides bright light between light samples and other rays
};

/// Lobes of GGX α below it are glossy: lamps are seen in them, which no neighbour must share.
inline constexpr float glossy_alpha = 0.15f;

class Mirroring;

/// Share of the residual rays that is drawn from the BSDF, so that no direction is left out.
inline constexpr float usual_bsdf_share = 0.15f;

/// A camera sample with the integral that stands for it.
struct IntegratedPoint {
    const ShadingPoint& x;
    const SampleStream& stream;
    const MapIntegral& integral;
    const ResidualDistribution& distribution;  // of `integral`
    Spectrum scale;                            // the point's integral is so many times `integral`
    float level;                               // the same of its radiance
    float rays;                                // residual rays that it gets on average
    float bsdf_share;                          // of them is drawn from the BSDF
    bool exact;  // the integral is that of its integrand; if not, rays that miss bring back the environment's
                 // mean over their texel, because the maps hold the same: only what is seen is estimated, not
                 // the environment's detail
};

/// A camera sample's sharp lobes, which no map holds.
struct LobePoint {
    const ShadingPoint& x;
    const SampleStream& stream;
    const SharpLobes& lobes;  // of its BSDF
    float rays;               // that are drawn from them on average; as many go to bright light
};

/// Estimates the difference between the light that points reflect and their map integrals. With residual rays
/// and exact integrals the estimates are unbiased, whatever the maps hold. Rays of several points are traced
/// together.
class ResidualEstimator {
  public:
    ResidualEstimator(const ResidualSettings& settings, RayCounts& counts)
        : settings_(settings), counts_(counts) {}

    /// Draws residual rays of a point; `sum` has all that they find after finish().
    void add(const IntegratedPoint& point, RaySeries series, FoundResidual& sum);
    /// The same of the usual number of rays towards bright surfaces.
    void add_cones(const ShadingPoint& x, const SampleStream& stream, FoundCones& sum);
    /// The same of a point's light samples: `rays` on average.
    void add_light(const ShadingPoint& x, const SampleStream& stream, float rays, RaySeries series,
                   FoundLight& sum);
    /// All that sharp lobes reflect, in the same way: nothing is held.
    void add_lobes(const LobePoint& point, SampledRadiance& sum);
    void finish();

  private:
    struct ResidualRay {
        FoundResidual* sum = nullptr;
        bool second_half = false;  // of its sequence
        std::uint32_t texel = 0;
        Spectrum bsdf;                 // f·|cos θ|; black where the surface is in the way
        float mirrors = 0;             // share of it that is glossy lobes
        MapRadiance held;              // the integrand in the maps
        float density = 0;             // of residual rays, times how many there are
        float bsdf_density = 0;        // of those drawn from the BSDF, likewise; 0 if this is none of them
        float usual_bsdf_density = 0;  // likewise, of as many as are usual: against the two below
        float cone_density = 0;        // of rays towards bright surfaces
        float light_budget = 0;        // usual rays of the point towards lights
        bool exact = false;
    };
    struct LightRay {
        FoundLight* sum = nullptr;
        bool second_half = false;
        Spectrum reflected;  // where nothing is in the way
        float mirrors = 0;   // share of it that is glossy lobes
    };
    struct ConeRay {
        FoundCones* sum = nullptr;
        bool second_half = false;
        Spectrum weight;  // of the radiance that bright surfaces reflect
    };
    struct Drawn {
        WorldDir direction;
        std::uint32_t texel;
        bool from_bsdf;
    };

    /// How many rays could have found bright light.
    struct LightDensities {
        float rays;       // light samples per camera sample
        float weighed;    // what weights take for it
        float bsdf_rays;  // those drawn from the BSDF, likewise
    };

    void add_residual(const IntegratedPoint& point, const Mirroring& mirroring, const SampleStream& stream,
                      FoundResidual& sum);
    void add_light_sample(const ShadingPoint& x, const Mirroring& mirroring, const SampleStream& stream,
                          float rays, FoundLight& sum);
    void add_lobe_ray(const LobePoint& point, float light_rays, const SampleStream& stream,
                      FoundResidual& sum);
    void add_lobe_light(const LobePoint& point, const SampleStream& stream, FoundLight& sum);
    template <typename Reflect, typename Mirrors>
    void add_light_ray(const ShadingPoint& x, const SampleStream& stream, const LightDensities& drawn,
                       const Reflect& reflect, const Mirrors& mirrors, FoundLight& sum);
    void wait_for(std::uint32_t depth);
    void add_cone(const ShadingPoint& x, const SampleStream& stream, FoundCones& sum);
    void see_cones(const ShadingPoint& x);
    [[nodiscard]] static std::optional<Drawn> draw(const IntegratedPoint& point, const SampleStream& stream);
    /// For weights between strategies: a fixed share, or light samples that come before would need the maps.
    [[nodiscard]] float usual_bsdf_rays() const;
    void trace_residual();
    void collect(const ResidualRay& drawn, const Ray& ray, const Hit& hit, const SplitRadiance& found) const;
    void trace_light();
    void trace_cones();

    const ResidualSettings& settings_;
    RayCounts& counts_;
    std::array<Ray, packet_size> residual_rays_, light_rays_;
    std::array<ResidualRay, packet_size> residual_;
    std::array<LightRay, packet_size> light_;
    StreamPacket residual_streams_;
    std::array<Ray, packet_size> cone_rays_;
    std::array<ConeRay, packet_size> cone_;
    StreamPacket cone_streams_;
    BrightCones::Table cones_;                  // from the point that rays are drawn for
    float light_budget_ = 0, cone_budget_ = 0;  // rays to lights and to bright surfaces, of RayBudget::light
    std::size_t residual_count_ = 0, light_count_ = 0, cone_count_ = 0;
    std::uint32_t depth_ = 0, cone_depth_ = 0;  // of the points whose rays wait
};

}  // namespace relumine
