// SPDX-License-Identifier: Apache-2.0
// The specular prefix.
#include "integrators/shading_point.hpp"

#include "radiance/direct_light.hpp"
#include "shading/sharp_lobes.hpp"

namespace relumine {
namespace {

/// Mirrors and glass that a prefix may meet: one that meets more is caught between lossless surfaces.
constexpr std::uint32_t longest_prefix = 1024;

/// Whether all that a BSDF without delta lobes reflects or transmits is in lobes below `alpha`.
bool is_nearly_smooth(const Bsdf& bsdf, float alpha) {
    if (const auto* glass = std::get_if<RoughDielectric>(&bsdf)) return glass->ggx.alpha < alpha;
    const auto lobes = sharp_lobes(bsdf, alpha);
    return lobes && is_black(lobes->rest);
}

/// Of all lights without size, and of one of the others, weighted against BSDF sampling.
Spectrum sampled_light(const Transport& t, const Vertex& vertex, const PathState& path,
                       const SampleStream& stream, RayCounts& rays) {
    const LightRandom u{stream.next2(Dim::light_point, path.depth),
                        stream.bits(Dim::opacity, 2 * path.depth + 1)};
    Spectrum sum = delta_light(t, vertex, u.opacity_seed, rays);
    const auto light = propose_direct_light(t, vertex, u);
    if (!light || light->delta) return sum;
    rays.add(RayPurpose::shadow);
    return sum + light->reflected * t.tracer.passed_light(light->shadow_ray);
}

}  // namespace

std::optional<ShadingPoint> follow_prefix(const Transport& t, const CameraSample& sample,
                                          const PrefixSettings& settings, Spectrum& emission,
                                          RayCounts& rays) {
    PathState path = sample.path;
    float distance = 0;
    while (path.hit && path.depth < longest_prefix) {
        distance += path.hit.t;
        Vertex vertex = make_vertex(t, path, sample.stream);
        emission += path.throughput * arriving_emission(t, path, &vertex.point);
        if (path.depth == settings.max_depth) return {};
        const float delta = delta_probability(vertex.bsdf, vertex.w_out);
        if (sample.stream.next1(Dim::lobe, path.depth) >= delta) {
            path.throughput *= 1 / (1 - delta);
            vertex.bsdf = without_delta(vertex.bsdf);
            if (delta > 0 || !is_nearly_smooth(vertex.bsdf, settings.sharp_alpha))
                return ShadingPoint{path, vertex, distance};
            emission += path.throughput * sampled_light(t, vertex, path, sample.stream, rays);
        }
        scatter_path(path, vertex, sample.stream);
        if (!path.alive) return {};
        rays.add(RayPurpose::prefix);
        path.hit = t.tracer.closest_hit(path.ray);
        tint(t, path);
    }
    if (!path.hit) emission += path.throughput * arriving_emission(t, path, nullptr);
    return {};
}

}  // namespace relumine
