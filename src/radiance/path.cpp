// SPDX-License-Identifier: Apache-2.0
// Following paths.
#include "radiance/path.hpp"

#include "radiance/direct_light.hpp"
#include "shading/material.hpp"
#include "shading/sampling.hpp"

namespace relumine {
namespace {

constexpr std::uint32_t roulette_depth = 4;       // scattering vertices before Russian roulette may end a path
constexpr float max_survival = 0.95f;             // so that even white scenes end
constexpr std::uint32_t depth_of_no_return = 4096;  // a path that lives so long meets lossless surfaces alone: it is lost

void add(SplitRadiance& sum, std::uint32_t scatterings, Spectrum radiance) {
    (scatterings == 0 ? sum.emission : scatterings == 1 ? sum.direct : sum.indirect) += radiance;
}

/// Ends paths by their throughput, or makes up for those that were ended.
bool survives(PathState& path, float u) {
    if (path.depth <= roulette_depth) return true;
    const float survival = std::min(max_component(path.throughput) * path.eta_scale, max_survival);
    if (!(u < survival)) return false;
    path.throughput *= 1 / survival;
    return true;
}

}  // namespace

Vertex make_vertex(const Transport& t, PathState& path, const SampleStream& stream) {
    const WorldDir w_out = -path.ray.direction;
    Vertex vertex{surface_point(t.scene, path.hit, w_out), {}, Lambert{}};
    const SurfacePoint& p = vertex.point;
    if (!p.front && attenuates(*p.material)) path.throughput *= transmittance(*p.material, path.hit.t);
    vertex.w_out = p.frame.to_local(w_out);
    vertex.bsdf = make_bsdf(t.scene, p, t.masking, p.material->transmission > 0 ? stream.next1(Dim::blend, path.depth) : 0.0f);
    return vertex;
}

bool extend_path(const Transport& t, PathState& path, const Vertex& vertex, const SampleStream& stream, RayPurpose purpose,
                 RayCounts& rays) {
    const BsdfRandom u{stream.next1(Dim::lobe, path.depth), stream.next2(Dim::direction, path.depth)};
    const auto scattered = sample(vertex.bsdf, vertex.w_out, u);
    if (!scattered || is_black(scattered->weight)) return false;
    const WorldDir w_in = vertex.point.frame.to_world(scattered->w_in);
    if (!sides_agree(vertex.point, w_in)) return false;
    path.throughput *= scattered->weight;
    path.eta_scale *= sqr(scattered->eta);
    path.bsdf_pdf = scattered->delta ? 0 : scattered->pdf;
    path.scatterings += scattered->delta ? 0 : 1;
    ++path.depth;
    path.count_emission = true;
    path.ray = {ray_origin(vertex.point, w_in), w_in, infinity, stream.bits(Dim::opacity, 2 * path.depth)};
    rays.add(purpose);
    path.hit = t.tracer.closest_hit(path.ray);
    return true;
}

Spectrum arriving_emission(const Transport& t, const PathState& path, const SurfacePoint* hit_point) {
    const Spectrum emitted = hit_point ? emitted_radiance(t.scene, *hit_point) : t.lights.environment_radiance(path.ray.direction);
    if (is_black(emitted) || path.bsdf_pdf == 0) return emitted;
    const float light_pdf = hit_point ? t.lights.pdf(path.ray.origin, *hit_point) : t.lights.environment_pdf(path.ray.direction);
    return emitted * mis_weight(path.bsdf_pdf, light_pdf);
}

SplitRadiance path_radiance(const Transport& t, PathState path, std::uint32_t max_depth, const SampleStream& stream, RayCounts& rays) {
    SplitRadiance sum;
    while (path.depth < depth_of_no_return) {
        if (!path.hit) {
            if (path.count_emission) add(sum, path.scatterings, path.throughput * arriving_emission(t, path, nullptr));
            break;
        }
        const Vertex vertex = make_vertex(t, path, stream);
        if (path.count_emission) add(sum, path.scatterings, path.throughput * arriving_emission(t, path, &vertex.point));
        if (path.depth >= max_depth) break;
        if (!is_delta(vertex.bsdf))
            add(sum, path.scatterings + 1, path.throughput * sampled_direct_light(t, vertex, stream, path.depth, rays));
        if (!extend_path(t, path, vertex, stream, RayPurpose::bounce, rays)) break;
        if (!survives(path, stream.next1(Dim::roulette, path.depth))) break;
    }
    return sum;
}

}  // namespace relumine
