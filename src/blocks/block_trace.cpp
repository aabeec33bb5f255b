// SPDX-License-Identifier: Apache-2.0
// Map rays, sixteen at a time.
#include "blocks/block_trace.hpp"

namespace relumine {
namespace {

/// A direction that stands lower than this over the anchor (sine) starts where it stands highest.
constexpr float low = 0.02f;

class MapTracer {
  public:
    MapTracer(const MapSource& source, std::span<const GatherPoint> starts, std::uint64_t key,
              MapRecord& record, RayCounts& counts)
        : source_(source), starts_(starts), key_(key), record_(record), counts_(counts) {}

    void run(const TileRays& tile_rays) {
        constexpr auto tile_size = static_cast<std::uint32_t>(tile_texels);
        for (std::uint32_t tile = 0; tile < source_.grid.tiles; ++tile) {
            if (tile_rays[tile] == 0) continue;
            const std::uint32_t texels = tile_size / tile_rays[tile];
            for (std::uint32_t i = 0; i < tile_size; i += texels) add(tile * tile_size + i, texels);
        }
        if (pending_ > 0) trace();
        record_.pad();
    }

  private:
    /// Queues the ray that stands for `texels` texels from `first` on; traces when a packet is full.
    void add(std::uint32_t first, std::uint32_t texels) {
        const std::uint64_t random = hash(key_, first, 0x6d6170);
        const auto number = [&](std::uint64_t bits) { return unit_float(static_cast<std::uint32_t>(bits)); };
        const std::uint32_t texel = first + (static_cast<std::uint32_t>(random >> 60) & (texels - 1));
        const WorldDir direction = source_.grid.direction_in(texel, {number(random), number(random >> 28)});
        const GatherPoint* start = start_of(direction);
        if (!start) return;
        const std::size_t lane = pending_++;
        queue_[lane] = {static_cast<std::uint16_t>(first), static_cast<std::uint16_t>(texels),
                        static_cast<std::uint16_t>(texel)};
        streams_[lane] = {key_, first, static_cast<std::uint32_t>(source_.grid.texels), PointSet::sobol};
        rays_[lane] = {start->position + start->frame.n * start->offset, direction, infinity,
                       streams_[lane].bits(Dim::opacity, 2 * start->depth + 2)};
        if (pending_ == packet_size) trace();
    }

    [[nodiscard]] const GatherPoint* start_of(WorldDir direction) const {
        const GatherPoint* best = &starts_[0];
        float highest = dot(best->frame.n, direction.v);
        if (highest > low) return best;
        for (const GatherPoint& start : starts_.subspan(1))
            if (const float height = dot(start.frame.n, direction.v); height > highest) {
                highest = height;
                best = &start;
            }
        return highest > 0 ? best : nullptr;
    }

    void trace() {
        for (std::size_t lane = pending_; lane < packet_size; ++lane) rays_[lane].t_max = -1;
        counts_.add(RayPurpose::record, pending_);
        std::array<Hit, packet_size> hits;
        source_.radiance.transport.tracer.closest_hits(rays_, hits, Coherence::coherent);
        std::array<Ray, packet_size> met = rays_;
        bool any = false;
        for (std::size_t lane = 0; lane < pending_; ++lane) {
            if (!hits[lane]) met[lane].t_max = -1;  // the environment is tabulated
            any |= static_cast<bool>(hits[lane]);
        }
        RadiancePacket found{};
        if (any)
            found = incident_radiance(source_.radiance, met, hits, starts_[0].depth + 1, streams_, counts_);
        for (std::size_t lane = 0; lane < pending_; ++lane) put(lane, hits[lane], found[lane]);
        pending_ = 0;
    }

    void put(std::size_t lane, const Hit& hit, SplitRadiance found) {
        const Ray& ray = rays_[lane];
        if (!hit) {
            const Tracer& tracer = source_.radiance.transport.tracer;
            record_.open.push_back(
                {tracer.has_coloured_panes() ? tracer.tint(ray, hit.t) : Spectrum{1}, queue_[lane]});
            return;
        }
        if (!is_black(found.direct)) found.direct *= 1 - source_.split.of_emission(ray, hit).share;
        if (!is_black(found.indirect) && source_.split.reflects_brightly(ray, hit)) found.indirect = {};
        if (!is_finite(found.total())) {
            ++counts_.non_finite;
            found = {};
        }
        const auto& scene = source_.radiance.transport.scene;
        const auto [a, b, c] = world_triangle(scene, hit.instance, hit.triangle);
        const Vec3 normal = normalize(cross(b - a, c - a));
        record_.add({found.direct, found.indirect, dot(normal, ray.direction.v) > 0 ? -normal : normal, hit.t,
                     queue_[lane]},
                    ray.origin + ray.direction.v * hit.t);
    }

    const MapSource& source_;
    std::span<const GatherPoint> starts_;
    std::uint64_t key_;
    MapRecord& record_;
    RayCounts& counts_;
    std::array<Ray, packet_size> rays_;
    std::array<TexelRun, packet_size> queue_;  // that the rays stand for
    StreamPacket streams_;
    std::size_t pending_ = 0;
};

}  // namespace

void trace_record(const MapSource& source, std::span<const GatherPoint> starts, const TileRays& tile_rays,
                  std::uint64_t key, MapRecord& record, RayCounts& rays) {
    record.anchor = starts.front();
    record.clear_rays();
    MapTracer(source, starts, key, record, rays).run(tile_rays);
}

}  // namespace relumine
