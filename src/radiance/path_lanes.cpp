// SPDX-License-Identifier: Apache-2.0
// Into lanes and out of them.
#include "radiance/path_lanes.hpp"

namespace relumine {

PathState PathLanes::get(std::size_t i, std::uint32_t depth) const {
    return {ray[i],        hit[i],       depth,         scatterings[i],
            throughput[i], eta_scale[i], bsdf_pdf[i],   count_emission[i] != 0,
            alive[i] != 0, sky_pdf[i],   light_share[i]};
}

void PathLanes::take(std::size_t i, const PathLanes& other, std::size_t j) {
    ray.take(i, other.ray, j);
    hit.take(i, other.hit, j);
    scatterings[i] = other.scatterings[j];
    throughput.take(i, other.throughput, j);
    eta_scale[i] = other.eta_scale[j];
    bsdf_pdf[i] = other.bsdf_pdf[j];
    sky_pdf[i] = other.sky_pdf[j];
    light_share[i] = other.light_share[j];
    count_emission[i] = other.count_emission[j];
    alive[i] = other.alive[j];
}

void ShadowLanes::take(std::size_t i, const ShadowLanes& other, std::size_t j) {
    rays.take(i, other.rays, j);
    radiance.take(i, other.radiance, j);
    scatterings[i] = other.scatterings[j];
}

void PathLanes::set(std::size_t i, const PathState& path) {
    ray.set(i, path.ray);
    hit.set(i, path.hit);
    scatterings[i] = path.scatterings;
    throughput.set(i, path.throughput);
    eta_scale[i] = path.eta_scale;
    bsdf_pdf[i] = path.bsdf_pdf;
    sky_pdf[i] = path.sky_pdf;
    light_share[i] = path.light_share;
    count_emission[i] = path.count_emission ? -1 : 0;
    alive[i] = path.alive ? -1 : 0;
}

void TriangleLanes::set(std::size_t i, const ShadingTriangle& triangle, const Hit& hit, Vec3 direction) {
    for (std::size_t corner = 0; corner < 3; ++corner) corners[corner].set(i, triangle.corners[corner]);
    normal.set(i, triangle.normal);
    winding[i] = triangle.winding;
    u[i] = hit.u;
    v[i] = hit.v;
    ray_direction.set(i, direction);
}

void set_anisotropy(std::size_t i, Vec3 lobe_axis, const Ggx& ggx, TriangleLanes& triangles,
                    LayerLanes& layers) {
    if (!layers.stretched) {
        layers.stretched = triangles.oriented = true;
        layers.stretch_x.fill(1);
        layers.stretch_y.fill(1);
        triangles.lobe_axis = {};
    }
    layers.stretch_x[i] = ggx.stretch_x;
    layers.stretch_y[i] = ggx.stretch_y;
    triangles.lobe_axis.set(i, lobe_axis);
}

void LayerLanes::set(std::size_t i, const MetallicRoughness& layers) {
    diffuse.set(i, layers.diffuse);
    coat_f0.set(i, layers.coat_f0);
    coat_f90.set(i, layers.coat_f90);
    specular_f0.set(i, layers.specular_f0);
    specular_f90.set(i, layers.specular_f90);
    alpha[i] = layers.ggx.alpha;
    separable[i] = layers.ggx.masking == Masking::separable ? -1 : 0;
}

}  // namespace relumine
