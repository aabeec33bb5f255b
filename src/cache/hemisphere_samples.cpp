// SPDX-License-Identifier: Apache-2.0
// The hemisphere's rays, in packets of 4 × 4 neighbouring texels.
#include "cache/hemisphere_samples.hpp"

#include "base/assert.hpp"
#include "cache/hemisphere_map.hpp"
#include "shading/surface_point.hpp"

namespace relumine {
namespace {

constexpr int block = 4;  // texels; block² = packet_size

/// A point in texel (u, v), uniform.
Point2 jittered(int u, int v, int side, std::uint64_t random) {
    const auto along = [&](int texel, std::uint64_t bits) {
        return (static_cast<float>(texel) + unit_float(static_cast<std::uint32_t>(bits)))
               / static_cast<float>(side);
    };
    return {along(u, random), along(v, random >> 32)};
}

Vec3 hit_normal(const SceneData& scene, const Hit& hit, WorldDir towards) {
    const auto [a, b, c] = world_triangle(scene, hit.instance, hit.triangle);
    const Vec3 n = cross(b - a, c - a);
    return face_forward(n / std::max(length(n), 1e-37f), towards.v);
}

struct HemisphereTracer {
    const IncidentRadiance& source;
    const GatherPoint& point;
    int side;
    std::uint64_t key;

    void trace_block(int u0, int v0, std::vector<TexelSample>& texels, RayCounts& counts) const {
        std::array<Ray, packet_size> rays;
        std::array<Hit, packet_size> hits;
        StreamPacket streams;
        for (int lane = 0; lane < block * block; ++lane) {
            const auto i = static_cast<std::size_t>(lane);
            const std::uint32_t texel = texel_index(u0 + lane % block, v0 + lane / block);
            streams[i] = {key, texel, static_cast<std::uint32_t>(side * side), PointSet::sobol};
            rays[i] = ray_through(u0 + lane % block, v0 + lane / block, streams[i]);
        }
        counts.add(RayPurpose::record, packet_size);
        source.transport.tracer.closest_hits(rays, hits, Coherence::coherent);
        const RadiancePacket incident =
            incident_radiance(source, rays, hits, point.depth + 1, streams, counts);
        for (std::size_t i = 0; i < packet_size; ++i) {
            const bool finite = is_finite(incident[i].total());
            counts.non_finite += finite ? 0 : 1;
            texels[streams[i].index] = texel_sample(rays[i], hits[i], finite ? incident[i] : SplitRadiance{});
        }
    }

    [[nodiscard]] std::uint32_t texel_index(int u, int v) const {
        return static_cast<std::uint32_t>(v * side + u);
    }

    [[nodiscard]] Ray ray_through(int u, int v, const SampleStream& stream) const {
        const std::uint64_t random = hash(key, stream.index, 0x6a6974746572);
        const WorldDir direction = point.frame.to_world(square_to_hemisphere(jittered(u, v, side, random)));
        return {point.position + point.frame.n * point.offset, direction, infinity,
                stream.bits(Dim::opacity, 2 * point.depth + 2)};
    }

    [[nodiscard]] TexelSample texel_sample(const Ray& ray, const Hit& hit,
                                           const SplitRadiance& incident) const {
        const Spectrum total = incident.total(), direct = incident.direct;
        if (!hit) return {total, direct, infinity, ray.direction.v, {}};
        return {total, direct, hit.t, ray.origin + ray.direction.v * hit.t - point.position,
                hit_normal(source.transport.scene, hit, -ray.direction)};
    }
};

}  // namespace

std::vector<TexelSample> trace_hemisphere(const IncidentRadiance& source, const GatherPoint& point, int side,
                                          std::uint64_t key, RayCounts& rays) {
    RELUMINE_ASSERT(side > 0 && side % block == 0);
    std::vector<TexelSample> texels(static_cast<std::size_t>(side) * static_cast<std::size_t>(side));
    const HemisphereTracer tracer{source, point, side, key};
    for (int v = 0; v < side; v += block)
        for (int u = 0; u < side; u += block) tracer.trace_block(u, v, texels, rays);
    return texels;
}

}  // namespace relumine
