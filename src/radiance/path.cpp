// SPDX-License-Identifier: Apache-2.0
// The steps of a path.
#include "radiance/path.hpp"

#include "shading/material.hpp"
#include "shading/sampling.hpp"

namespace relumine {

bool survives(PathState& path, float u) {
    if (!may_end(path.depth)) return true;
    const float survival =
        std::min(max_component(path.throughput) * path.eta_scale, max_survival(path.depth));
    if (!(u < survival)) return false;
    path.throughput *= 1 / survival;
    return true;
}

void scatter(PathState& path, const Vertex& vertex, const std::optional<BsdfSample>& scattered,
             std::uint32_t opacity_seed) {
    path.alive = false;
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
        const Mesh& mesh = t.scene.meshes[index(t.scene.instances[p.instance].mesh)];
        vertex.bsdf = t.tracer.has_panes() && pane_kind(t.scene, mesh) != Pane::none
                          ? make_pane_bsdf(t.scene, path.hit, p, vertex.w_out, t.masking, u)
                          : make_bsdf(t.scene, p, t.masking, u);
    }
    return vertex;
}

void scatter_path(PathState& path, const Vertex& vertex, const SampleStream& stream) {
    const BsdfRandom u{has_lobes(vertex.bsdf) ? stream.next1(Dim::lobe, path.depth) : 0.0f,
                       stream.next2(Dim::direction, path.depth)};
    scatter(path, vertex, sample(vertex.bsdf, vertex.w_out, u),
            stream.bits(Dim::opacity, 2 * path.depth + 2));
}

Spectrum arriving_emission(const Transport& t, const PathState& path, const SurfacePoint* hit_point) {
    const Spectrum emitted =
        hit_point ? emitted_radiance(t.scene, *hit_point) : t.lights.environment_radiance(path.ray.direction);
    if (is_black(emitted) || path.bsdf_pdf == 0) return emitted;
    const float light_pdf =
        hit_point ? path.light_share * t.lights.pdf(path.ray.origin, *hit_point)
                  : path.light_share * t.lights.environment_pdf(path.ray.direction) + path.sky_pdf;
    return emitted * mis_weight(path.bsdf_pdf, light_pdf);
}

}  // namespace relumine
