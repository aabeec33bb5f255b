// SPDX-License-Identifier: Apache-2.0
// Following a ray through glossy reflections, mirrors and glass to the surfaces that reflect it diffusely.
#pragma once

#include <vector>

#include "radiance/path.hpp"

namespace relumine {

/// Lobes at least this rough (GGX α) count as diffuse.
inline constexpr float rough_alpha = 0.4f;

/// How far lobes are followed.
struct LobeWalk {
    std::uint32_t max_depth = unlimited_depth;  // scattering vertices of a whole path
    int most_rough = 10;  // of reflections at lobes that are no deltas; further ones count as diffuse
    float eagerness =
        4;  // a lobe that keeps the share a of the light is followed with probability eagerness · a
    bool sample_lights = true;  // else `found` is of no use
};

/// Where a part of a path's light comes from a surface that reflects diffusely.
struct DiffuseVertex {
    const Vertex& vertex;
    Spectrum weight;  // the path's throughput times the directional albedo
};

/// Follows the living of `paths` whose rays have hit. Calls `use(i, DiffuseVertex)` at every surface on the
/// way of path i for what it reflects diffusely, and goes on along its lobes; where `use` says false, because
/// it knows nothing of the light there, the diffuse part is followed as well. Light that is met after the
/// first surface, and the lights' own light in lobes, is added to `found`, by path. Unbiased, if `use` is and
/// roughnesses are kept, for the light that the surfaces at the paths' hits reflect; but for what a caustic
/// map holds for the surfaces that the rays have left. The paths go in step, so that their rays are traced as
/// packets: the same ones must always go together.
template <typename Use>
void walk_lobes(const Transport& t, std::span<PathState> paths, const LobeWalk& settings,
                std::span<const SampleStream> streams, std::span<Spectrum> found, RayCounts& rays,
                const Use& use);

/// A path that is followed.
struct Walker {
    std::uint32_t path;  // which one
    int rough = 0;       // reflections so far
    bool photons;        // whether they have come the same way so far
};

/// Rays of one step of many walks.
class WalkStep {
  public:
    /// Light sampling at `vertex`, if wanted, unless photons have found that light, and a direction drawn
    /// from its BSDF.
    void propose(const Transport& t, const Walker& walker, PathState& path, const Vertex& vertex,
                 bool sample_lights, const SampleStream& stream);
    /// Adds the lights' light to `found` and takes the walks' paths to their next hits.
    void trace(const Transport& t, std::span<const Walker> walkers, std::span<PathState> paths,
               std::span<Spectrum> found, RayCounts& rays);

  private:
    struct Light {
        std::uint32_t path;
        Ray shadow_ray;
        Spectrum radiance;  // if nothing is in the way
    };
    std::vector<Light> lights_;
};

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

/// Keeps the walkers that `go_on`, in order.
template <typename GoOn>
void keep(std::vector<Walker>& walkers, const GoOn& go_on) {
    std::size_t kept = 0;
    for (Walker w : walkers)
        if (go_on(w)) walkers[kept++] = w;
    walkers.resize(kept);
}

/// One step of a walk up to its ray; false where it ends.
template <typename Use>
bool step_lobes(const Transport& t, Walker& walker, PathState& path, const LobeWalk& settings,
                const SampleStream& stream, Spectrum& found, WalkStep& step, const Use& use) {
    Vertex vertex = make_vertex(t, path, stream);
    if (path.count_emission && !walker.photons)
        found += path.throughput * arriving_emission(t, path, &vertex.point);
    if (path.depth >= settings.max_depth) return false;
    const WalkChoice choice = choose(vertex, path.throughput, walker.rough, settings);
    const bool known =
        is_black(choice.diffuse) || use(walker.path, DiffuseVertex{vertex, path.throughput * choice.diffuse});
    if (known) {
        if (!choice.follow || stream.next1(Dim::roulette, path.depth) >= choice.probability) return false;
        path.throughput *= 1 / choice.probability;
        vertex.bsdf = *choice.follow;
    }
    walker.photons = walker.photons && known && choice.caustic;
    walker.rough += choice.delta ? 0 : 1;
    step.propose(t, walker, path, vertex, settings.sample_lights, stream);
    return true;
}

template <typename Use>
void walk_lobes(const Transport& t, std::span<PathState> paths, const LobeWalk& settings,
                std::span<const SampleStream> streams, std::span<Spectrum> found, RayCounts& rays,
                const Use& use) {
    constexpr int longest = 64;  // reflections and refractions, for light that is caught between mirrors
    std::vector<Walker> walkers;
    walkers.reserve(paths.size());
    for (std::uint32_t i = 0; i < paths.size(); ++i) {
        paths[i].count_emission = false;  // at the first hit that is the caller's
        if (paths[i].alive && paths[i].hit) walkers.push_back({i, 0, t.caustics != nullptr});
    }
    WalkStep step;
    for (int i = 0; i < longest && !walkers.empty(); ++i) {
        keep(walkers, [&](Walker& w) {
            return step_lobes(t, w, paths[w.path], settings, streams[w.path], found[w.path], step, use);
        });
        step.trace(t, walkers, paths, found, rays);
        keep(walkers, [&](const Walker& w) {
            const PathState& path = paths[w.path];
            if (path.alive && !path.hit && !w.photons)
                found[w.path] += path.throughput * arriving_emission(t, path, nullptr);
            return path.alive && path.hit;
        });
    }
}

}  // namespace relumine
