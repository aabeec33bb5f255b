// SPDX-License-Identifier: Apache-2.0
// The specular prefix.
#include "integrators/shading_point.hpp"

namespace relumine {
namespace {

/// Mirrors and glass that a prefix may meet: one that meets more is caught between lossless surfaces.
constexpr std::uint32_t longest_prefix = 1024;

}  // namespace

std::optional<ShadingPoint> follow_prefix(const Transport& t, const CameraSample& sample,
                                          std::uint32_t max_depth, Spectrum& emission, RayCounts& rays) {
    PathState path = sample.path;
    float distance = 0;
    while (path.hit && path.depth < longest_prefix) {
        distance += path.hit.t;
        Vertex vertex = make_vertex(t, path, sample.stream);
        emission += path.throughput * arriving_emission(t, path, &vertex.point);
        if (path.depth == max_depth) return {};
        const float delta = delta_probability(vertex.bsdf, vertex.w_out);
        if (sample.stream.next1(Dim::lobe, path.depth) >= delta) {
            path.throughput *= 1 / (1 - delta);
            vertex.bsdf = without_delta(vertex.bsdf);
            return ShadingPoint{path, vertex, distance};
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
