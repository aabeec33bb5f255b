// SPDX-License-Identifier: Apache-2.0
// Grouping samples and splitting blocks.
#include "blocks/block_partition.hpp"

#include "blocks/map_fill.hpp"
#include "blocks/parallax.hpp"

namespace relumine {
namespace {

using Points = std::vector<const BlockPoint*>;

/// Samples may lie so far off the anchor's plane, against the block's side.
constexpr float plane_tolerance = 0.25f;

/// Rays may start at so many samples of a group, and so many say which directions matter.
constexpr std::size_t most_starts = 8, most_receivers = 4;

/// However few samples a group has, its map gets about so many rays.
constexpr float least_rays = 96;

float distance_from(float x, float y, const CachePoint& point) {
    return sqr(static_cast<float>(point.x) + 0.5f - x) + sqr(static_cast<float>(point.y) + 0.5f - y);
}

const BlockPoint* nearest(const Points& points, float x, float y) {
    return *std::ranges::min_element(points, {},
                                     [&](const BlockPoint* p) { return distance_from(x, y, *p->point); });
}

/// Up to `most` of a group, its anchor first.
Points some_of(const Points& group, std::size_t most) {
    Points some;
    const std::size_t step = (group.size() + most - 1) / most;
    for (std::size_t i = 0; i < group.size(); i += step) some.push_back(group[i]);
    return some;
}

class Partition {
  public:
    Partition(const MapSource& source, const BlockSettings& settings, std::vector<MapRecord>& records,
              RayCounts& rays)
        : source_(source),
          settings_(settings),
          records_(records),
          rays_(rays),
          map_bytes_(settings.map_weight
                     * static_cast<double>(BlockMap::bytes(source.grid, source.radiance.reflects()))),
          fill_(source.grid, source.environment) {
        for (auto& plane : bsdf_) plane.resize(source.grid.tiles);
    }

    /// Adds the records of the samples in the square block of `size` pixels with its corner at (x, y). Each
    /// sample has so many bytes for them.
    void divide(Points points, int x, int y, int size, double bytes_per_point) {
        while (!points.empty()) {
            const Points group = take_group(points, x, y, size);
            const auto count = static_cast<double>(group.size());
            const double bytes = bytes_per_point * count;
            if (bytes < map_bytes_) continue;
            MapRecord record = traced(group, x, y, size);
            const double record_bytes = static_cast<double>(record.bytes()),
                         rest = bytes - record_bytes - map_bytes_;
            if (rest < 0) continue;
            record.has_map = size <= settings_.smallest || group.size() == 1
                             || rest < 4 * (record_bytes + map_bytes_)
                             || error_of(record, group) <= settings_.tolerance;
            const bool divided = !record.has_map;
            records_.push_back(std::move(record));
            if (divided) divide_quarters(group, x, y, size / 2, (bytes - record_bytes) / count);
        }
    }

  private:
    /// Takes the samples that are like the one nearest to the block's middle; that comes first.
    Points take_group(Points& points, int x, int y, int size) const {
        const float half = 0.5f * static_cast<float>(size);
        const BlockPoint* const anchor =
            nearest(points, static_cast<float>(x) + half, static_cast<float>(y) + half);
        const float tolerance = plane_tolerance * static_cast<float>(size) * anchor->point->footprint;
        const GatherPoint& a = anchor->point->gather;
        const auto belongs = [&](const BlockPoint* p) {
            const GatherPoint& g = p->point->gather;
            return p == anchor
                   || (g.depth == a.depth && dot(g.frame.n, a.frame.n) >= settings_.min_cos_normals
                       && std::abs(dot(g.position - a.position, a.frame.n)) <= tolerance);
        };
        const auto rest = std::stable_partition(points.begin(), points.end(), belongs);
        Points group(points.begin(), rest);
        points.erase(points.begin(), rest);
        std::swap(group.front(), *std::ranges::find(group, anchor));
        return group;
    }

    MapRecord traced(const Points& group, int x, int y, int size) {
        std::vector<GatherPoint> starts;
        for (const BlockPoint* p : some_of(group, most_starts)) starts.push_back(p->point->gather);
        weigh_tiles(group);
        MapRecord record;
        record.footprint = group.front()->point->footprint;
        record.size = static_cast<float>(size);
        record.center_x = static_cast<float>(x) + 0.5f * record.size;
        record.center_y = static_cast<float>(y) + 0.5f * record.size;
        trace_record(source_, starts, tile_rays(group, starts),
                     hash(group.front()->point->key, static_cast<std::uint64_t>(size)), record, rays_);
        return record;
    }

    /// By tile, the mean f·|cos θ| of some receivers of the group.
    void weigh_tiles(const Points& group) {
        const DirectionGrid& grid = source_.grid;
        weights_.assign(grid.tiles, 0);
        for (const BlockPoint* p : some_of(group, most_receivers)) {
            evaluate(p->bsdf, {grid.tile_x, grid.tile_y, grid.tile_z}, {bsdf_[0], bsdf_[1], bsdf_[2]});
            for (std::size_t tile = 0; tile < grid.tiles; ++tile)
                weights_[tile] += luminance({bsdf_[0][tile], bsdf_[1][tile], bsdf_[2][tile]});
        }
    }

    /// The group's rays go where its receivers look.
    TileRays tile_rays(const Points& group, std::span<const GatherPoint> starts) const {
        const DirectionGrid& grid = source_.grid;
        const float pixels =
            static_cast<float>(group.size()) / static_cast<float>(settings_.samples_per_pixel);
        const float rays = std::clamp(settings_.rays_per_pixel * pixels, least_rays, settings_.most_rays);
        float sum = 0;
        for (const float weight : weights_) sum += weight;
        TileRays tile_rays(grid.tiles);
        for (std::size_t tile = 0; tile < grid.tiles; ++tile) {
            const Vec3 center = grid.tile_center(tile).v;
            const auto sees = [&](const GatherPoint& p) {
                return dot(p.frame.n, center) > -grid.tile_sine[tile];
            };
            if (std::ranges::none_of(starts, sees)) continue;
            const float wanted = sum > 0 ? rays * weights_[tile] / sum : 0;
            tile_rays[tile] = wanted > 6 ? 16 : wanted > 1.5f ? 4 : 1;
        }
        return tile_rays;
    }

    [[nodiscard]] float error_of(const MapRecord& record, const Points& group) {
        float extent = 0;
        for (const BlockPoint* p : group)
            extent = std::max(extent, length_squared(p->point->gather.position - record.anchor.position));
        fill_.run(record, {}, source_.radiance.reflects(), map_);
        fill_.distances(record, distances_);
        return parallax_error(source_.grid, map_, distances_, weights_, std::sqrt(extent), settings_.level);
    }

    void divide_quarters(const Points& group, int x, int y, int size, double bytes_per_point) {
        for (int quarter = 0; quarter < 4; ++quarter) {
            const int x0 = x + quarter % 2 * size, y0 = y + quarter / 2 * size;
            Points inside;
            std::ranges::copy_if(group, std::back_inserter(inside), [&](const BlockPoint* p) {
                return p->point->x >= x0 && p->point->x < x0 + size && p->point->y >= y0
                       && p->point->y < y0 + size;
            });
            divide(std::move(inside), x0, y0, size, bytes_per_point);
        }
    }

    const MapSource& source_;
    const BlockSettings& settings_;
    std::vector<MapRecord>& records_;
    RayCounts& rays_;
    double map_bytes_;  // weighed
    MapFill fill_;
    BlockMap map_;                            // from one record alone
    std::vector<float> weights_, distances_;  // of the group: by tile, by texel
    std::array<std::vector<float>, 3> bsdf_;  // scratch
};

}  // namespace

std::vector<MapRecord> make_records(const MapSource& source, const PixelRect& cell,
                                    std::span<const BlockPoint> points, const BlockSettings& settings,
                                    RayCounts& rays) {
    std::vector<MapRecord> records;
    Partition partition(source, settings, records, rays);
    const int size = settings.largest;
    const double bytes_per_point =
        settings.most_bytes / static_cast<double>(std::max<std::size_t>(points.size(), 1));
    for (int y = cell.y0; y < cell.y1; y += size)
        for (int x = cell.x0; x < cell.x1; x += size) {
            Points inside;
            for (const BlockPoint& p : points)
                if (p.point->x >= x && p.point->x < x + size && p.point->y >= y && p.point->y < y + size)
                    inside.push_back(&p);
            partition.divide(std::move(inside), x, y, size, bytes_per_point);
        }
    return records;
}

}  // namespace relumine
