// SPDX-License-Identifier: Apache-2.0
// Rays along lobes, and light samples.
#include "integrators/lobe_gather.hpp"

#include "integrators/gather_rays.hpp"
#include "radiance/direct_light.hpp"
#include "rivals/polar_hemisphere.hpp"

namespace relumine {
namespace {

constexpr int rays_per_pixel = 64, light_samples_per_pixel = 16;
constexpr std::uint64_t lobe_purpose = 0x6c6f6265, light_purpose = 0x627269676874;

std::uint32_t chosen(int wanted, int per_pixel, int samples) {
    return static_cast<std::uint32_t>(wanted >= 0 ? wanted : (per_pixel + samples - 1) / samples);
}

}  // namespace

LobeGather::LobeGather(const RenderSettings& settings, const IncidentRadiance& source,
                       const BrightSplit& split)
    : source_(source),
      split_(split),
      rays_(std::max(1u, chosen(settings.glossy_rays, rays_per_pixel, settings.samples_per_pixel))),
      light_samples_(std::max(
          1u, chosen(settings.light_samples, light_samples_per_pixel, settings.samples_per_pixel))) {}

SplitRadiance LobeGather::gathered(const ShadingPoint& x, const Bsdf& lobes, const SampleStream& stream,
                                   RayCounts& counts) const {
    const Transport& t = source_.transport;
    SplitRadiance sum;
    for (std::uint32_t first = 0; first < rays_; first += packet_size) {
        std::array<LobeRay, packet_size> drawn;
        std::array<Ray, packet_size> rays;
        std::array<Hit, packet_size> hits;
        StreamPacket streams;
        for (std::uint32_t lane = 0; lane < packet_size; ++lane) {
            rays[lane].t_max = -1;
            if (first + lane >= rays_) continue;
            streams[lane] = gather_stream(stream, lobe_purpose, first + lane, rays_);
            rays[lane] = sample_ray(x, lobes, streams[lane], drawn[lane]);
            if (rays[lane].t_max >= 0) counts.add(RayPurpose::gather);
        }
        t.tracer.closest_hits(rays, hits, Coherence::incoherent);
        const RadiancePacket found =
            incident_radiance(source_, rays, hits, x.path.depth + 1, streams, counts);
        for (std::size_t i = 0; i < packet_size; ++i) {
            if (rays[i].t_max < 0) continue;
            const DimPart part = split_direct(t, split_, rays[i], hits[i], found[i].direct);
            const float lobe_density = static_cast<float>(rays_) * drawn[i].pdf,
                        light_density = static_cast<float>(light_samples_) * part.bright.pdf;
            const float share = lobe_density > 0 ? lobe_density / (lobe_density + light_density) : 0;
            sum.direct += drawn[i].weight * (part.direct + found[i].direct * (part.bright.share * share));
            sum.indirect += drawn[i].weight * found[i].indirect;
        }
    }
    const float share = 1 / static_cast<float>(rays_);
    return {{}, sum.direct * share, sum.indirect * share};
}

Ray LobeGather::sample_ray(const ShadingPoint& x, const Bsdf& lobes, const SampleStream& stream,
                           LobeRay& ray) {
    const Ray none{{}, {}, -1, 0};
    const BsdfRandom u{stream.next1(Dim::lobe, x.path.depth), stream.next2(Dim::direction, x.path.depth)};
    const auto scattered = sample(lobes, x.vertex.w_out, u);
    if (!scattered || is_black(scattered->weight)) return none;
    const WorldDir w_in = x.vertex.point.frame.to_world(scattered->w_in);
    if (!sides_agree(x.vertex.point, w_in)) return none;
    ray = {scattered->weight, scattered->pdf};
    return {ray_origin(x.vertex.point, w_in), w_in, infinity,
            stream.bits(Dim::opacity, 2 * x.path.depth + 2)};
}

Spectrum LobeGather::bright(const ShadingPoint& x, const Bsdf* lobes, const SampleStream& stream,
                            RayCounts& counts) const {
    const Vertex& vertex = x.vertex;
    Spectrum sum;
    if (split_.empty()) return sum;
    for (std::uint32_t i = 0; i < light_samples_; ++i) {
        const SampleStream s = gather_stream(stream, light_purpose, i, light_samples_);
        const auto light =
            split_.lights().sample(vertex.point.position, s.next2(Dim::light_point, x.path.depth));
        if (!light || !(light->pdf > 0) || !sides_agree(vertex.point, light->w_in)) continue;
        const LocalDir w_in = vertex.point.frame.to_local(light->w_in);
        const BsdfValue by_lobes = lobes ? evaluate(*lobes, vertex.w_out, w_in) : BsdfValue{};
        const float density = static_cast<float>(light_samples_) * light->pdf;
        const Spectrum diffuse = eval(vertex.bsdf, vertex.w_out, w_in) - by_lobes.value;
        const Spectrum weight =
            diffuse / density + by_lobes.value / (density + static_cast<float>(rays_) * by_lobes.pdf);
        const Spectrum reflected = weight * light->radiance * split_.share(*light);
        if (is_black(reflected)) continue;
        sum += reflected
               * passed_light(source_.transport, vertex.point, *light,
                              s.bits(Dim::opacity, 2 * x.path.depth + 1), counts);
    }
    return sum;
}

}  // namespace relumine
