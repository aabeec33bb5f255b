// SPDX-License-Identifier: Apache-2.0
// Drawing rays and tracing them in packets.
#include "radiance/field_rays.hpp"

#include <array>

#include "shading/sampling.hpp"

namespace relumine {
namespace {

/// Streams and their numbers for the direction, by the part of the hemisphere that these stand for: rays of a
/// packet go together, and what follows finds triangles and cells in the processor's caches.
struct DirectedStreams {
    std::vector<SampleStream> streams;
    std::vector<Point2> numbers;

    explicit DirectedStreams(std::span<const SampleStream> drawn)
        : streams(drawn.size()), numbers(drawn.size()) {
        std::vector<Point2> u;
        for (const SampleStream& s : drawn) u.push_back(s.next2(Dim::direction));
        std::array<std::uint32_t, cells + 1> next{};
        for (const Point2 p : u) ++next[cell_of(p) + 1];
        for (std::size_t i = 1; i < next.size(); ++i) next[i] += next[i - 1];
        for (std::size_t i = 0; i < u.size(); ++i) {
            const std::uint32_t place = next[cell_of(u[i])]++;
            streams[place] = drawn[i];
            numbers[place] = u[i];
        }
    }

  private:
    static constexpr std::size_t cells = 16;
    /// Four by four, in Morton order.
    static std::size_t cell_of(Point2 p) {
        constexpr std::array<std::uint8_t, 4> spread{0, 1, 4, 5};
        const auto quarter = [](float x) { return static_cast<std::size_t>(std::min(4 * x, 3.0f)); };
        return static_cast<std::size_t>(spread[quarter(p.x)] | spread[quarter(p.y)] << 1);
    }
};

}  // namespace

SampleStream element_stream(std::uint64_t seed, ElementId element, std::uint32_t ray, int rays) {
    return {hash(seed, element, 0x656c656d656e74), ray, static_cast<std::uint32_t>(rays), PointSet::sobol};
}

void add_arriving(IrradianceVector& vector, Vec3 normal, Vec3 direction, Spectrum irradiance) {
    const float cosine = dot(direction, normal);
    const Vec3 along = direction - normal * cosine;
    vector.add(normal + along / std::max(cosine, least_tilt_cosine), irradiance);
}

/// A direction in the frame of `normal` as it was in that of `from`: what it makes with the normal stays.
Vec3 turned(Vec3 direction, Vec3 from, Vec3 normal) {
    const float cosine = dot(direction, from);
    Vec3 along = direction - from * cosine;
    along = along - normal * dot(along, normal);
    const float sine = std::sqrt(std::max(0.0f, 1 - sqr(cosine))), length_along = length(along);
    return normal * cosine + (length_along > 1e-6f ? along * (sine / length_along) : Vec3{});
}

void trace(const Transport& t, ElementRays& all, RayCounts& counts) {
    counts.add(RayPurpose::field, all.size());
    all.hits.resize(all.size());
    for (std::size_t first = 0; first < all.size(); first += packet_size) {
        const std::size_t count = std::min(packet_size, all.size() - first);
        RayLanes rays;
        HitLanes hits;
        rays.t_max.fill(-1);
        for (std::size_t i = 0; i < count; ++i) rays.set(i, all.rays[first + i]);
        t.tracer.closest_hits(rays, hits, Coherence::incoherent);
        for (std::size_t i = 0; i < count; ++i)
            all.hits[first + i] = hits.instance[i] == no_instance ? Hit{} : hits[i];
    }
}

ElementRays trace_rays(const Transport& t, std::span<const StartPoint> points, ElementId id, int count,
                       std::uint64_t seed, RayCounts& counts) {
    std::vector<SampleStream> drawn;
    for (int i = 0; i < count; ++i)
        drawn.push_back(element_stream(seed, id, static_cast<std::uint32_t>(i), count));
    DirectedStreams directed(drawn);
    ElementRays all;
    all.rays.reserve(drawn.size());
    for (std::size_t i = 0; i < drawn.size(); ++i) {
        const SampleStream& stream = directed.streams[i];
        const StartPoint& p = points[point_of(points, static_cast<int>(stream.index), count)];
        const WorldDir direction = frame_around(p.normal).to_world(cosine_hemisphere(directed.numbers[i]));
        all.rays.push_back({p.position + p.normal * p.offset, direction, infinity,
                            t.tracer.asks_for_opacity() ? stream.bits(Dim::opacity, 2) : 0u});
    }
    all.streams = std::move(directed.streams);
    trace(t, all, counts);
    return all;
}

}  // namespace relumine
