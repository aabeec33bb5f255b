// SPDX-License-Identifier: Apache-2.0
// Gather rays in packets, and samples of bright light.
#include "integrators/gather_estimate.hpp"

#include "integrators/gather_rays.hpp"
#include "integrators/light_source.hpp"
#include "radiance/direct_light.hpp"

namespace relumine {
namespace {

/// Light whose radiance exceeds this many times the environment's mean is also sampled directly, if light
/// samples are asked for.
constexpr float bright_factor = 4;

constexpr std::uint64_t gather_purpose = 0x676174686572;

}  // namespace

/// One gather ray: the BSDF sample behind it and its own random numbers.
struct GatherEstimate::GatherRay {
    SampleStream stream;
    Spectrum weight;  // f·|cos θ| / pdf
    float pdf = 0;
};

GatherEstimate::GatherEstimate(const RenderSettings& settings, const Transport& transport, const View& view)
    : transport_(transport),
      source_(incident_source(settings, transport)),
      rays_(static_cast<std::uint32_t>(settings.gather_rays)),
      light_samples_(static_cast<std::uint32_t>(std::max(settings.light_samples, 0))),
      packets_(settings.gather_packets),
      coherence_(view.point_set == PointSet::stratified ? Coherence::coherent : Coherence::incoherent) {
    const LightSelection bright{bright_threshold(transport.scene, bright_factor), false, false};
    if (light_samples_ > 0) bright_lights_ = std::make_unique<LightSampler>(transport.scene, bright);
}

SplitRadiance GatherEstimate::reflected(const ShadingPoint& x, const SampleStream& stream,
                                        RayCounts& rays) const {
    SplitRadiance sum = gather(x, stream, rays);
    sum.direct += bright_light(x, stream, rays);
    return sum;
}

SplitRadiance GatherEstimate::gather(const ShadingPoint& x, const SampleStream& stream,
                                     RayCounts& counts) const {
    SplitRadiance sum;
    for (std::uint32_t first = 0; first < rays_; first += packet_size) {
        std::array<GatherRay, packet_size> gather_rays;
        std::array<Ray, packet_size> rays;
        std::array<Hit, packet_size> hits;
        StreamPacket streams;
        for (std::uint32_t lane = 0; lane < packet_size; ++lane) {
            rays[lane].t_max = -1;
            if (first + lane >= rays_) continue;
            streams[lane] = gather_rays[lane].stream =
                gather_stream(stream, gather_purpose, first + lane, rays_);
            rays[lane] = sample_ray(x, gather_rays[lane]);
            if (rays[lane].t_max >= 0) counts.add(RayPurpose::gather);
        }
        if (packets_)
            transport_.tracer.closest_hits(rays, hits, coherence_);
        else
            for (std::size_t i = 0; i < packet_size; ++i)
                if (rays[i].t_max >= 0) hits[i] = transport_.tracer.closest_hit(rays[i]);
        const RadiancePacket incident =
            incident_radiance(source_, rays, hits, x.path.depth + 1, streams, counts);
        for (std::size_t i = 0; i < packet_size; ++i) {
            if (rays[i].t_max < 0) continue;
            if (!is_black(incident[i].direct))
                sum.direct += gather_rays[i].weight * incident[i].direct
                              * bsdf_share(rays[i], hits[i], gather_rays[i].pdf);
            sum.indirect += gather_rays[i].weight * incident[i].indirect;
        }
    }
    const float share = 1 / static_cast<float>(rays_);
    return {{}, sum.direct * share, sum.indirect * share};
}

/// Draws a gather ray from the BSDF; the returned ray has t_max < 0 where nothing is reflected.
Ray GatherEstimate::sample_ray(const ShadingPoint& x, GatherRay& ray) const {
    const Ray none{{}, {}, -1, 0};
    const BsdfRandom u{has_lobes(x.vertex.bsdf) ? ray.stream.next1(Dim::lobe, x.path.depth) : 0.0f,
                       direction_numbers(ray.stream, x.path.depth)};
    const auto scattered = sample(x.vertex.bsdf, x.vertex.w_out, u);
    if (!scattered || is_black(scattered->weight)) return none;
    const WorldDir w_in = x.vertex.point.frame.to_world(scattered->w_in);
    if (!sides_agree(x.vertex.point, w_in)) return none;
    ray.weight = scattered->weight;
    ray.pdf = scattered->pdf;
    return {ray_origin(x.vertex.point, w_in), w_in, infinity,
            ray.stream.bits(Dim::opacity, 2 * x.path.depth + 2)};
}

/// The balance heuristic's share of BSDF sampling against the samples of the bright light.
float GatherEstimate::bsdf_share(const Ray& ray, const Hit& hit, float bsdf_pdf) const {
    if (!bright_lights_) return 1;
    const float light_pdf =
        hit ? bright_lights_->pdf(ray.origin, surface_point(transport_.scene, hit, -ray.direction))
            : bright_lights_->environment_pdf(ray.direction);
    const float bsdf_density = static_cast<float>(rays_) * bsdf_pdf;
    return bsdf_density / (bsdf_density + static_cast<float>(light_samples_) * light_pdf);
}

/// Samples of the bright part of the light, weighed against the gather rays.
Spectrum GatherEstimate::bright_light(const ShadingPoint& x, const SampleStream& stream,
                                      RayCounts& rays) const {
    Spectrum sum;
    if (!bright_lights_ || bright_lights_->empty()) return sum;
    for (std::uint32_t i = 0; i < light_samples_; ++i) {
        const SampleStream s{hash(stream.key, 0x627269676874), stream.index * light_samples_ + i,
                             stream.count * light_samples_, stream.set};
        const auto light =
            bright_lights_->sample(x.vertex.point.position, s.next1(Dim::light_choice, x.path.depth),
                                   s.next2(Dim::light_point, x.path.depth));
        if (!light) continue;
        const Spectrum reflected = unshadowed(x.vertex, *light);
        if (is_black(reflected)) continue;
        const Spectrum passed = passed_light(transport_, x.vertex.point, *light,
                                             s.bits(Dim::opacity, 2 * x.path.depth + 1), rays);
        const float bsdf_pdf = pdf(x.vertex.bsdf, x.vertex.w_out, x.vertex.point.frame.to_local(light->w_in));
        sum += reflected * passed
               / (static_cast<float>(light_samples_) * light->pdf + static_cast<float>(rays_) * bsdf_pdf);
    }
    return sum;
}

}  // namespace relumine
