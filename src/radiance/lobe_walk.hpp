// SPDX-License-Identifier: Apache-2.0
// Following a ray through glossy reflections, mirrors and glass to the surfaces that reflect it diffusely.
#pragma once

#include "radiance/path.hpp"

namespace relumine {

/// Lobes at least this rough (GGX α) count as diffuse.
inline constexpr float rough_alpha = 0.4f;

/// How far lobes are followed.
struct LobeWalk {
    std::uint32_t max_depth = unlimited_depth;  // scattering vertices of a whole path
    int most_rough = 3;  // of reflections at lobes that are no deltas; further ones count as diffuse
    float eagerness =
        4;  // a lobe that keeps the share a of the light is followed with probability eagerness · a
};

/// Where a part of a path's light comes from a surface that reflects diffusely.
struct DiffuseVertex {
    const Vertex& vertex;
    Spectrum weight;  // the path's throughput times the directional albedo
};

/// Follows `path`, whose ray has hit. Calls `use(DiffuseVertex)` at every surface on the way for what it
/// reflects diffusely, and goes on along its lobes; where `use` says false, because it knows nothing of the
/// light there, the diffuse part is followed as well. Light that is met after the first surface, and the
/// lights' own light in lobes, is added to `found`. Unbiased, if `use` is and roughnesses are kept, for the
/// light that the surface at the path's hit reflects; but for what a caustic map holds for the surface that
/// the ray has left.
template <typename Use>
void walk_lobes(const Transport& t, PathState path, const LobeWalk& settings, const SampleStream& stream,
                Spectrum& found, RayCounts& rays, const Use& use);

/// A step of such a walk: light sampling at `vertex`, unless photons have found that light, then a direction
/// drawn from its BSDF, and its hit.
void step_along(const Transport& t, PathState& path, const Vertex& vertex, bool photons,
                const SampleStream& stream, Spectrum& found, RayCounts& rays);

/// What becomes of a path at a surface: what is diffuse is used, the rest followed.
struct WalkChoice {
    Spectrum diffuse;            // directional albedo of what is used here
    std::optional<Bsdf> follow;  // empty: nothing
    float probability = 1;       // of following
    bool delta = false;          // `follow` is one: it does not count as rough
    bool caustic = false;        // photons follow it as well
};
[[nodiscard]] WalkChoice choose(const Vertex& vertex, Spectrum throughput, int rough_so_far,
                                const LobeWalk& settings);

template <typename Use>
void walk_lobes(const Transport& t, PathState path, const LobeWalk& settings, const SampleStream& stream,
                Spectrum& found, RayCounts& rays, const Use& use) {
    constexpr int longest = 64;  // reflections and refractions, for light that is caught between mirrors
    int rough = 0;
    bool photons = t.caustics != nullptr;  // whether they have come the same way so far
    path.count_emission = false;           // at the first hit that is the caller's
    for (int i = 0; i < longest && path.hit; ++i) {
        Vertex vertex = make_vertex(t, path, stream);
        if (path.count_emission && !photons)
            found += path.throughput * arriving_emission(t, path, &vertex.point);
        if (path.depth >= settings.max_depth) return;
        const WalkChoice choice = choose(vertex, path.throughput, rough, settings);
        const bool known =
            is_black(choice.diffuse) || use(DiffuseVertex{vertex, path.throughput * choice.diffuse});
        if (known) {
            if (!choice.follow || stream.next1(Dim::roulette, path.depth) >= choice.probability) return;
            path.throughput *= 1 / choice.probability;
            vertex.bsdf = *choice.follow;
        }
        photons = photons && known && choice.caustic;
        rough += choice.delta ? 0 : 1;
        step_along(t, path, vertex, photons, stream, found, rays);
        if (!path.alive) return;
    }
    if (!path.hit && path.count_emission && !photons)
        found += path.throughput * arriving_emission(t, path, nullptr);
}

}  // namespace relumine
