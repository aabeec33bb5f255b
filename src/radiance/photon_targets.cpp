// SPDX-License-Identifier: Apache-2.0
// Specular triangles, drawn by area and object.
#include "radiance/photon_targets.hpp"

#include <algorithm>
#include <cmath>

#include "radiance/photon_trace.hpp"
#include "shading/material.hpp"
#include "shading/surface_point.hpp"

namespace relumine {
namespace {

constexpr float coat_share = 0.05f;  // of the photons of a mirror: what a dielectric reflects

/// What LobeSplit has as α is no less, but where a texture makes surfaces smoother.
float least_mean_alpha(const Material& m) {
    const float alpha = sqr(m.roughness);
    if (!is_anisotropic(m) || m.anisotropy_texture) return alpha;
    return std::sqrt(alpha * lerp(alpha, 1.0f, sqr(m.anisotropy)));
}

bool may_be_specular(const Material& m) {
    if (!is_black(m.diffuse_transmission)) return false;
    if (m.coated_diffuse) return m.specular > 0 && least_mean_alpha(m) < caustic_alpha;
    if (!m.metallic_roughness_texture && least_mean_alpha(m) >= caustic_alpha) return false;
    return m.transmission > 0 || m.metallic > 0 || m.specular > 0;
}

/// Mirrors and glass against dielectric coats.
float strength(const Material& m) { return m.transmission > 0 || m.metallic > 0 ? 1 : coat_share; }

}  // namespace

PhotonTargets::PhotonTargets(const SceneData& scene) {
    double sum = 0;
    for (std::uint32_t i = 0; i < scene.instances.size(); ++i) {
        const Mesh& mesh = scene.meshes[index(scene.instances[i].mesh)];
        const Material& material = scene.materials[index(mesh.material)];
        if (may_be_specular(material)) add(scene, i, strength(material), sum);
    }
}

std::size_t PhotonTargets::draw(float u) const {
    const double at = double{u} * sums_.back();
    const auto found = std::ranges::upper_bound(sums_, at);
    return std::min(static_cast<std::size_t>(found - sums_.begin()), targets_.size() - 1);
}

float PhotonTargets::density(std::size_t i) const {
    const double share = (sums_[i] - (i > 0 ? sums_[i - 1] : 0)) / sums_.back();
    return static_cast<float>(share / double{targets_[i].area});
}

void PhotonTargets::add(const SceneData& scene, std::uint32_t instance, float strength, double& sum) {
    const Mesh& mesh = scene.meshes[index(scene.instances[instance].mesh)];
    const std::size_t first = targets_.size();
    double area = 0;
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        const auto [a, b, c] = world_triangle(scene, instance, t);
        const float size = 0.5f * length(cross(b - a, c - a));
        if (!(size > 0)) continue;
        targets_.push_back({instance, t, size});
        area += double{size};
    }
    for (std::size_t i = first; i < targets_.size(); ++i)
        sums_.push_back(sum += double{strength} * double{targets_[i].area} / std::sqrt(area));
}

bool has_specular_surfaces(const SceneData& scene) {
    return std::ranges::any_of(scene.instances, [&](const Instance& instance) {
        return may_be_specular(scene.materials[index(scene.meshes[index(instance.mesh)].material)]);
    });
}

}  // namespace relumine
