// SPDX-License-Identifier: Apache-2.0
// The steps of a walk along lobes.
#include "radiance/lobe_walk.hpp"

#include "radiance/direct_light.hpp"
#include "radiance/photon_trace.hpp"
#include "shading/reflectance.hpp"

namespace relumine {
namespace {

constexpr std::size_t least_packet = 8;  // fewer rays are faster one by one

/// Calls `use` for sixteen of `all` at a time, and for those that are left.
template <typename T, typename Use>
void for_packets(std::span<const T> all, const Use& use) {
    for (std::size_t first = 0; first < all.size(); first += packet_size)
        use(all.subspan(first, std::min(packet_size, all.size() - first)));
}

/// The rays of up to sixteen, and others that are none.
template <typename T, typename RayOf>
RayLanes packet_of(std::span<const T> some, const RayOf& ray_of) {
    RayLanes rays;
    rays.t_max.fill(-1);
    for (std::size_t i = 0; i < some.size(); ++i) rays.set(i, ray_of(some[i]));
    return rays;
}

void trace_bounces(const Transport& t, std::span<const std::uint32_t> some, std::span<PathState> paths) {
    if (some.size() < least_packet) {
        for (const std::uint32_t i : some) paths[i].hit = t.tracer.closest_hit(paths[i].ray);
    } else {
        HitLanes hits;
        t.tracer.closest_hits(packet_of(some, [&](std::uint32_t i) { return paths[i].ray; }), hits,
                              Coherence::incoherent);
        for (std::size_t i = 0; i < some.size(); ++i)
            paths[some[i]].hit = hits.instance[i] == no_instance ? Hit{} : hits[i];
    }
    for (const std::uint32_t i : some) tint(t, paths[i]);
}

}  // namespace

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

void WalkStep::propose(const Transport& t, const Walker& walker, PathState& path, const Vertex& vertex,
                       bool sample_lights, const SampleStream& stream) {
    if (sample_lights && !walker.photons && !is_delta(vertex.bsdf)) {
        const LightRandom u{stream.next2(Dim::light_point, path.depth),
                            stream.bits(Dim::opacity, 2 * path.depth + 1)};
        if (const auto light = propose_direct_light(t, vertex, u))
            lights_.push_back({walker.path, light->shadow_ray, path.throughput * light->reflected});
    }
    scatter_path(path, vertex, stream);
}

void WalkStep::trace(const Transport& t, std::span<const Walker> walkers, std::span<PathState> paths,
                     std::span<Spectrum> found, RayCounts& rays) {
    rays.add(RayPurpose::shadow, lights_.size());
    for_packets(std::span<const Light>(lights_), [&](std::span<const Light> some) {
        SpectrumLanes passed;
        passed_light(t.tracer, packet_of(some, [](const Light& l) { return l.shadow_ray; }), some.size(),
                     passed);
        for (std::size_t i = 0; i < some.size(); ++i) found[some[i].path] += some[i].radiance * passed[i];
    });
    lights_.clear();
    std::vector<std::uint32_t> bounces;
    bounces.reserve(walkers.size());
    for (const Walker& w : walkers)
        if (paths[w.path].alive) bounces.push_back(w.path);
    rays.add(RayPurpose::bounce, bounces.size());
    for_packets(std::span<const std::uint32_t>(bounces),
                [&](std::span<const std::uint32_t> some) { trace_bounces(t, some, paths); });
}

}  // namespace relumine
