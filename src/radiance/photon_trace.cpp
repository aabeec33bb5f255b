// SPDX-License-Identifier: Apache-2.0
// Photons from light samples at specular surfaces on [Jensen96].
#include "radiance/photon_trace.hpp"

#include <mutex>

#include "base/executor.hpp"
#include "radiance/direct_light.hpp"
#include "radiance/lobe_walk.hpp"
#include "radiance/photon_targets.hpp"
#include "shading/material.hpp"
#include "shading/reflectance.hpp"
#include "shading/sampling.hpp"

namespace relumine {
namespace {

constexpr std::uint32_t paths_at_once = 1024;
constexpr std::uint64_t photon_purpose = 0x70686f746f6e;
constexpr int longest_path = 64;  // reflections and refractions
/// What shading normals may do to a photon's flux at a vertex: grazing ones would make it arbitrarily strong.
constexpr float most_correction = 8;

/// The share of light that meets the surface at `hit` instead of passing it.
Spectrum met_share(const Transport& t, const Hit& hit, WorldDir direction) {
    const Mesh& mesh = t.scene.meshes[index(t.scene.instances[hit.instance].mesh)];
    if (pane_kind(t.scene, mesh) != Pane::none)
        return Spectrum{1 - max_component(pane_transmittance(t.scene, hit, direction))};
    const Material& material = t.scene.materials[index(mesh.material)];
    return Spectrum{opacity(t.scene, material, texture_coordinates(t.scene, hit))};
}

/// Follows one photon after the other.
class PhotonTracer {
  public:
    PhotonTracer(const Transport& t, const PhotonTargets& targets, const LightSampler& lights,
                 const PhotonSettings& settings, std::vector<Photon>& photons, RayCounts& rays)
        : t_(t), targets_(targets), lights_(lights), settings_(settings), photons_(photons), rays_(rays) {}

    void run(std::uint32_t i) {
        const SampleStream stream{hash(settings_.seed, photon_purpose), i, settings_.paths, PointSet::sobol};
        PathState path;
        const Spectrum flux = begin(path, stream);
        if (!is_black(flux) && is_finite(flux)) follow(path, flux, stream);
    }

  private:
    /// Puts the path on a specular surface that light has reached; its flux, 0 where none has.
    Spectrum begin(PathState& path, const SampleStream& stream) {
        const std::size_t drawn = targets_.draw(stream.next1(Dim::light_choice));
        const PhotonTargets::Target& target = targets_[drawn];
        const Point2 b = uniform_triangle(stream.next2(Dim::pixel));
        const Hit hit{0, b.x, b.y, target.instance, target.triangle};
        const Vec3 place = surface_point(t_.scene, hit, {{0, 0, 1}}).position;
        const auto light = lights_.sample(place, stream.next2(Dim::light_point));
        if (!light || !(light->pdf > 0)) return {};
        const SurfacePoint p = surface_point(t_.scene, hit, light->w_in);
        const float cosine = dot(p.geometric_normal, light->w_in.v);
        if (!(cosine > 0)) return {};
        path.ray = {p.position, -light->w_in, infinity, 0};
        path.hit = hit;
        if (std::isfinite(light->distance)) path.hit.t = light->distance;
        const Spectrum met = met_share(t_, hit, -light->w_in);
        if (is_black(met)) return {};
        const Spectrum passed = passed_light(t_, p, *light, stream.bits(Dim::opacity, 1), rays_);
        const float density = light->pdf * targets_.density(drawn) * static_cast<float>(settings_.paths);
        return light->radiance * passed * met * (cosine / density);
    }

    void follow(PathState path, Spectrum flux, const SampleStream& stream) {
        int rough = 0;
        for (std::uint32_t i = 0; i < longest_path; ++i) {
            Vertex vertex = make_vertex(t_, path, stream);
            if (i > 0) deposit(path, vertex, flux, i);
            if (i >= settings_.most_specular || !turn(path, vertex, rough, stream)) return;
            rays_.add(RayPurpose::photon);
            path.hit = t_.tracer.closest_hit(path.ray);
            if (!path.hit) return;
            tint(t_, path);
        }
    }

    void deposit(const PathState& path, const Vertex& vertex, Spectrum flux, std::uint32_t specular) {
        if (is_delta(vertex.bsdf)) return;
        const Spectrum arrived = flux * path.throughput * path.eta_scale;
        if (is_black(arrived) || !is_finite(arrived)) return;
        photons_.push_back(
            {vertex.point.position, vertex.point.geometric_normal, -path.ray.direction.v, arrived, specular});
    }

    /// Sends the photon on along the vertex' sharp lobes, if it has any and the photon survives.
    static bool turn(PathState& path, Vertex& vertex, int& rough, const SampleStream& stream) {
        const LobeSplit split = split_lobes(vertex.bsdf, vertex.w_out);
        if (!is_caustic_lobe(split) || (split.alpha > 0 && rough >= LobeWalk{}.most_rough)) return false;
        const float kept = split.transmits ? 1 : std::min(2 * max_component(split.glossy), 1.0f);
        if (stream.next1(Dim::roulette, 2 * path.depth) >= kept) return false;
        path.throughput *= 1 / kept;
        rough += split.alpha > 0 ? 1 : 0;
        vertex.bsdf = *split.lobes;
        const Vec3 came = -path.ray.direction.v;
        scatter_path(path, vertex, stream);
        if (!path.alive) return false;
        path.throughput *= shading_correction(vertex.point, came, path.ray.direction.v);
        return survives(path, stream.next1(Dim::roulette, 2 * path.depth + 1));
    }

    /// What light's weight has over that of importance where normals are interpolated [Veach97, §5.3.2].
    static float shading_correction(const SurfacePoint& p, Vec3 came, Vec3 goes) {
        const auto cosine = [](Vec3 a, Vec3 b) { return std::abs(dot(a, b)); };
        const float over = cosine(came, p.frame.n) * cosine(goes, p.geometric_normal);
        const float under = cosine(came, p.geometric_normal) * cosine(goes, p.frame.n);
        return over < most_correction * under ? over / under : most_correction;
    }

    const Transport& t_;
    const PhotonTargets& targets_;
    const LightSampler& lights_;
    const PhotonSettings& settings_;
    std::vector<Photon>& photons_;
    RayCounts& rays_;
};

}  // namespace

bool is_caustic_lobe(const LobeSplit& split) { return split.lobes && split.alpha < caustic_alpha; }

std::vector<Photon> trace_photons(const Transport& t, const PhotonSettings& settings, RayCounts& rays) {
    const PhotonTargets targets(t.scene);
    // Nothing else finds these paths: the environment must be drawn wherever it shines.
    const LightSampler lights(t.scene, {.compensate_for_mis = false});
    if (targets.empty() || lights.empty()) return {};
    std::vector<std::vector<Photon>> found((settings.paths + paths_at_once - 1) / paths_at_once);
    std::mutex mutex;
    parallel_for(settings.threads, found.size(), [&](std::size_t chunk) {
        if (settings.stop && settings.stop()) return;
        RayCounts counts;
        PhotonTracer tracer(t, targets, lights, settings, found[chunk], counts);
        const auto first = static_cast<std::uint32_t>(chunk) * paths_at_once;
        for (std::uint32_t i = first; i < std::min(first + paths_at_once, settings.paths); ++i) tracer.run(i);
        const std::lock_guard lock(mutex);
        rays.add(counts);
    });
    std::vector<Photon> all;
    for (const auto& photons : found) all.insert(all.end(), photons.begin(), photons.end());
    return all;
}

}  // namespace relumine
