// SPDX-License-Identifier: Apache-2.0
// The steps of a walk along lobes.
#include "radiance/lobe_walk.hpp"

#include "radiance/direct_light.hpp"
#include "radiance/photon_trace.hpp"
#include "shading/reflectance.hpp"

namespace relumine {

WalkChoice choose(const Vertex& vertex, Spectrum throughput, int rough_so_far, const LobeWalk& settings) {
    const LobeSplit split = split_lobes(vertex.bsdf, vertex.w_out);
    if (split.transmits) return {{}, split.lobes, 1, split.alpha == 0, is_caustic_lobe(split)};
    const bool follow =
        split.lobes && split.alpha < rough_alpha && (split.alpha == 0 || rough_so_far < settings.most_rough);
    if (!follow) return {split.diffuse + split.glossy, {}, 0, false, false};
    // A lobe on its own is followed as it is; beside a diffuse part, as far as it matters.
    const float kept = settings.eagerness * max_component(throughput * split.glossy);
    return {split.diffuse, split.lobes, is_black(split.diffuse) ? 1 : std::min(kept, 1.0f), split.alpha == 0,
            is_caustic_lobe(split)};
}

void step_along(const Transport& t, PathState& path, const Vertex& vertex, bool photons,
                const SampleStream& stream, Spectrum& found, RayCounts& rays) {
    if (!photons && !is_delta(vertex.bsdf)) {
        const LightRandom u{stream.next2(Dim::light_point, path.depth),
                            stream.bits(Dim::opacity, 2 * path.depth + 1)};
        if (const auto light = propose_direct_light(t, vertex, u)) {
            rays.add(RayPurpose::shadow);
            found += path.throughput * light->reflected * t.tracer.passed_light(light->shadow_ray);
        }
    }
    scatter_path(path, vertex, stream);
    if (!path.alive) return;
    rays.add(RayPurpose::bounce);
    path.hit = t.tracer.closest_hit(path.ray);
    tint(t, path);
}

}  // namespace relumine
