// SPDX-License-Identifier: Apache-2.0
// Following paths.
#include "radiance/path.hpp"

#include "base/sample_packet_kernel.hpp"
#include "radiance/direct_light.hpp"
#include "shading/material.hpp"
#include "shading/sampling.hpp"

namespace relumine {
namespace {

constexpr std::uint32_t roulette_depth = 4;    // scattering vertices before Russian roulette may end a path
constexpr std::uint32_t lossless_depth = 256;  // from here on even paths that have lost nothing may end
constexpr float max_survival = 0.95f;          // of those

constexpr std::size_t least_packet = 8;  // fewer rays are faster one by one

void add(SplitRadiance& sum, std::uint32_t scatterings, Spectrum radiance) {
    (scatterings == 0 ? sum.emission : scatterings == 1 ? sum.direct : sum.indirect) += radiance;
}

/// Ends paths by their throughput, or makes up for those that were ended.
bool survives(PathState& path, float u) {
    if (path.depth <= roulette_depth) return true;
    const float survival = std::min(max_component(path.throughput) * path.eta_scale,
                                    path.depth < lossless_depth ? 1.0f : max_survival);
    if (!(u < survival)) return false;
    path.throughput *= 1 / survival;
    return true;
}

/// What one step of a packet of paths draws, except what few materials ask for.
struct StepNumbers {
    SamplePacket::Lanes<float> light_x, light_y, lobe, direction_x, direction_y, roulette;
    SamplePacket::Lanes<std::uint32_t> shadow_opacity{}, bounce_opacity{};

    StepNumbers(const SamplePacket& samples, std::uint32_t depth, bool opacity) {
        samples.next2(Dim::light_point, depth, light_x, light_y);
        samples.next1(Dim::lobe, depth, lobe);
        samples.next2(Dim::direction, depth, direction_x, direction_y);
        if (depth + 1 > roulette_depth) samples.next1(Dim::roulette, depth + 1, roulette);
        if (!opacity) return;
        samples.bits(Dim::opacity, 2 * depth + 1, shadow_opacity);
        samples.bits(Dim::opacity, 2 * depth + 2, bounce_opacity);
    }

    [[nodiscard]] LightRandom light(std::size_t lane) const {
        return {{light_x[lane], light_y[lane]}, shadow_opacity[lane]};
    }
    [[nodiscard]] BsdfRandom bsdf(std::size_t lane) const {
        return {lobe[lane], {direction_x[lane], direction_y[lane]}};
    }
};

/// Scatters the path by the given numbers: see scatter_path.
void scatter(PathState& path, const Vertex& vertex, BsdfRandom u, std::uint32_t opacity_seed) {
    path.alive = false;
    const auto scattered = sample(vertex.bsdf, vertex.w_out, u);
    if (!scattered || is_black(scattered->weight)) return;
    const WorldDir w_in = vertex.point.frame.to_world(scattered->w_in);
    if (!sides_agree(vertex.point, w_in)) return;
    path.alive = true;
    path.throughput *= scattered->weight;
    path.eta_scale *= sqr(scattered->eta);
    path.bsdf_pdf = scattered->delta ? 0 : scattered->pdf;
    path.scatterings += scattered->delta ? 0 : 1;
    ++path.depth;
    path.count_emission = true;
    path.ray = {ray_origin(vertex.point, w_in), w_in, infinity, opacity_seed};
}

/// The light proposals of one step of a packet of paths.
struct ShadowPacket {
    std::array<Ray, packet_size> rays;  // t_max < 0 where there is none
    std::array<Spectrum, packet_size> radiance;
    std::array<std::uint32_t, packet_size> scatterings;

    ShadowPacket() {
        for (Ray& ray : rays) ray.t_max = -1;
    }
};

/// One step of a path at its hit: counts emission, proposes direct light, scatters.
void advance(const Transport& t, PathState& path, std::uint32_t max_depth, const SampleStream& stream,
             const StepNumbers& numbers, SplitRadiance& sum, ShadowPacket& shadows, std::size_t lane) {
    if (!path.hit) {
        if (path.count_emission)
            add(sum, path.scatterings, path.throughput * arriving_emission(t, path, nullptr));
        path.alive = false;
        return;
    }
    const Vertex vertex = make_vertex(t, path, stream);
    if (path.count_emission)
        add(sum, path.scatterings, path.throughput * arriving_emission(t, path, &vertex.point));
    path.alive = path.depth < max_depth;
    if (!path.alive) return;
    if (!is_delta(vertex.bsdf)) {
        if (const auto light = propose_direct_light(t, vertex, numbers.light(lane))) {
            shadows.rays[lane] = light->shadow_ray;
            shadows.radiance[lane] = path.throughput * light->reflected;
            shadows.scatterings[lane] = path.scatterings + 1;
        }
    }
    scatter(path, vertex, numbers.bsdf(lane), numbers.bounce_opacity[lane]);
    path.alive = path.alive && survives(path, numbers.roulette[lane]);
}

std::size_t count_active(const std::array<Ray, packet_size>& rays) {
    return static_cast<std::size_t>(
        std::ranges::count_if(rays, [](const Ray& ray) { return ray.t_max >= 0; }));
}

void add_unshadowed(const Transport& t, const ShadowPacket& shadows, RadiancePacket& sums, RayCounts& rays) {
    const std::size_t active = count_active(shadows.rays);
    rays.add(RayPurpose::shadow, active);
    std::array<bool, packet_size> blocked{};
    if (active >= least_packet) t.tracer.occluded(shadows.rays, blocked);
    for (std::size_t i = 0; i < packet_size; ++i) {
        if (shadows.rays[i].t_max < 0) continue;
        if (active < least_packet) blocked[i] = t.tracer.occluded(shadows.rays[i]);
        if (!blocked[i]) add(sums[i], shadows.scatterings[i], shadows.radiance[i]);
    }
}

void trace_bounces(const Transport& t, PathPacket& paths, RayCounts& rays) {
    std::array<Ray, packet_size> bounces;
    for (std::size_t i = 0; i < packet_size; ++i) {
        bounces[i] = paths[i].ray;
        if (!paths[i].alive) bounces[i].t_max = -1;
    }
    const std::size_t active = count_active(bounces);
    rays.add(RayPurpose::bounce, active);
    std::array<Hit, packet_size> hits;
    if (active >= least_packet) t.tracer.closest_hits(bounces, hits, Coherence::incoherent);
    for (std::size_t i = 0; i < packet_size; ++i)
        if (paths[i].alive)
            paths[i].hit = active >= least_packet ? hits[i] : t.tracer.closest_hit(bounces[i]);
}

}  // namespace

Vertex make_vertex(const Transport& t, PathState& path, const SampleStream& stream) {
    const WorldDir w_out = -path.ray.direction;
    Vertex vertex{surface_point(t.scene, path.hit, w_out), {}, Lambert{}};
    const SurfacePoint& p = vertex.point;
    if (!p.front && attenuates(*p.material)) path.throughput *= transmittance(*p.material, path.hit.t);
    vertex.w_out = p.frame.to_local(w_out);
    if (const Bsdf* uniform = t.uniform_bsdfs.find(p)) {
        vertex.bsdf = *uniform;
    } else {
        const float u = p.material->transmission > 0 ? stream.next1(Dim::blend, path.depth) : 0.0f;
        vertex.bsdf = make_bsdf(t.scene, p, t.masking, u);
    }
    return vertex;
}

void scatter_path(PathState& path, const Vertex& vertex, const SampleStream& stream) {
    const BsdfRandom u{has_lobes(vertex.bsdf) ? stream.next1(Dim::lobe, path.depth) : 0.0f,
                       stream.next2(Dim::direction, path.depth)};
    scatter(path, vertex, u, stream.bits(Dim::opacity, 2 * path.depth + 2));
}

Spectrum arriving_emission(const Transport& t, const PathState& path, const SurfacePoint* hit_point) {
    const Spectrum emitted =
        hit_point ? emitted_radiance(t.scene, *hit_point) : t.lights.environment_radiance(path.ray.direction);
    if (is_black(emitted) || path.bsdf_pdf == 0) return emitted;
    const float light_pdf =
        hit_point ? t.lights.pdf(path.ray.origin, *hit_point) : t.lights.environment_pdf(path.ray.direction);
    return emitted * mis_weight(path.bsdf_pdf, light_pdf);
}

RadiancePacket path_radiance(const Transport& t, PathPacket paths, std::uint32_t max_depth,
                             const StreamPacket& streams, RayCounts& rays) {
    RadiancePacket sums;
    const SamplePacket samples(streams);
    for (;;) {
        const auto leader = std::ranges::find_if(paths, &PathState::alive);
        if (leader == paths.end()) break;
        const StepNumbers numbers(samples, leader->depth, t.tracer.asks_for_opacity());
        ShadowPacket shadows;
        for (std::size_t i = 0; i < packet_size; ++i)
            if (paths[i].alive) advance(t, paths[i], max_depth, streams[i], numbers, sums[i], shadows, i);
        add_unshadowed(t, shadows, sums, rays);
        trace_bounces(t, paths, rays);
    }
    return sums;
}

}  // namespace relumine
