// SPDX-License-Identifier: Apache-2.0
// Direct light by sampling the lights.
#include "radiance/direct_light.hpp"

#include "shading/sampling.hpp"

namespace relumine {

Ray shadow_ray(const SurfacePoint& point, const LightSample& light, std::uint32_t opacity_seed) {
    Ray ray{ray_origin(point, light.w_in), light.w_in, infinity, opacity_seed};
    if (!std::isfinite(light.distance)) return ray;
    const Vec3 way = light.target - ray.origin;
    const float distance = length(way);
    if (distance > 0) ray.direction = {way / distance};
    ray.t_max = distance;
    return ray;
}

Spectrum passed_light(const Transport& t, const SurfacePoint& point, const LightSample& light,
                      std::uint32_t opacity_seed, RayCounts& rays) {
    rays.add(RayPurpose::shadow);
    return t.tracer.passed_light(shadow_ray(point, light, opacity_seed));
}

void passed_light(const Tracer& tracer, const RayLanes& rays, std::size_t count, SpectrumLanes& share) {
    constexpr std::size_t least_packet = 8;  // fewer rays are faster one by one
    if (count < least_packet) {
        for (std::size_t i = 0; i < count; ++i) share.set(i, tracer.passed_light(rays[i]));
    } else if (tracer.has_panes()) {
        tracer.passed_light(rays, share);
    } else {
        LaneMask blocked;
        tracer.occluded(rays, blocked);
        for (std::size_t i = 0; i < count; ++i) share.set(i, Spectrum{blocked[i] != 0 ? 0.0f : 1.0f});
    }
}

Spectrum unshadowed(const Vertex& vertex, const LightSample& light) {
    if (!sides_agree(vertex.point, light.w_in)) return {};
    return eval(vertex.bsdf, vertex.w_out, vertex.point.frame.to_local(light.w_in)) * light.radiance;
}

std::optional<LightProposal> propose_direct_light(const Transport& t, const Vertex& vertex,
                                                  const LightRandom& u, const PathGuide* guide) {
    const Vec3 from = vertex.point.position;
    const auto light = guide ? guide->sample_light(t.lights, from, u.point) : t.lights.sample(from, u.point);
    if (!light) return {};
    if (!sides_agree(vertex.point, light->w_in)) return {};
    const auto [value, bsdf_pdf] =
        evaluate(vertex.bsdf, vertex.w_out, vertex.point.frame.to_local(light->w_in));
    const Spectrum reflected = value * light->radiance;
    if (is_black(reflected)) return {};
    const float pdf = guide && !light->delta ? guide->pdf(light->w_in, bsdf_pdf) : bsdf_pdf;
    const float weight = light->delta ? 1 : mis_weight(light->pdf, pdf);
    return LightProposal{shadow_ray(vertex.point, *light, u.opacity_seed), reflected * (weight / light->pdf),
                         light->delta};
}

Spectrum delta_light(const Transport& t, const Vertex& vertex, std::uint32_t opacity_seed, RayCounts& rays) {
    Spectrum sum;
    for (const LightSample& light : delta_light_samples(t.scene, vertex.point.position)) {
        const Spectrum reflected = unshadowed(vertex, light);
        if (!is_black(reflected)) sum += reflected * passed_light(t, vertex.point, light, opacity_seed, rays);
    }
    return sum;
}

}  // namespace relumine
