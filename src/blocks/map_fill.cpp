// SPDX-License-Identifier: Apache-2.0
// Sorting points into texels.
#include "blocks/map_fill.hpp"

#include <algorithm>

namespace relumine {
namespace {

/// Radians that an occluder may move between two anchors for what is behind it to count all the same: about
/// a tile's side (.22). Less leaves more noise, much more darkens.
constexpr float most_parallax = 0.3f;

/// Off a tangent plane, against the distance from where it touches: a point that is no farther behind it is
/// not hidden by what lies in it.
constexpr float plane_tolerance = 0.05f;

constexpr std::uint32_t none = ~std::uint32_t{0};

/// A point's share of solid angle may change so much.
constexpr float most_growth = 4;

/// In a tile's Morton order: the last texel of its first row, and of its first column.
constexpr std::size_t row_end = 5, column_end = 10;

Vec3 position_of(const MapRecord& record, std::size_t i) { return {record.x[i], record.y[i], record.z[i]}; }

/// Whether point `i` of `other` is behind the plane that touches the surface at point `near` of `record`.
bool lies_behind(const MapRecord& record, std::uint32_t near, const MapRecord& other, std::size_t i) {
    const Vec3 off = position_of(other, i) - position_of(record, near);
    const float height = dot(off, record.seen[near].normal);
    return height < 0 && sqr(height) > sqr(plane_tolerance) * length_squared(off);
}

}  // namespace

std::vector<const MapRecord*> nearest_records(const MapRecord& record,
                                              std::span<const MapRecord* const> candidates,
                                              std::size_t most) {
    struct Found {
        float distance2;
        const MapRecord* record;
    };
    std::vector<Found> found;
    for (const MapRecord* other : candidates)
        if (other != &record && other->anchor.depth == record.anchor.depth)
            found.push_back({length_squared(other->anchor.position - record.anchor.position), other});
    std::ranges::stable_sort(found, {}, &Found::distance2);
    found.resize(std::min(found.size(), most));
    std::vector<const MapRecord*> records;
    for (const Found& f : found) records.push_back(f.record);
    return records;
}

MapFill::MapFill(const DirectionGrid& grid, const DimEnvironment& environment)
    : grid_(grid), environment_(environment) {
    for (std::size_t tile = 0; tile < grid.tiles; ++tile) {
        right_.push_back(grid.right[tile * tile_texels + row_end] / tile_texels);
        below_.push_back(grid.below[tile * tile_texels + column_end] / tile_texels);
    }
}

void MapFill::Sum::add(const Sum& s) {
    direct += s.direct;
    indirect += s.indirect;
    tint += s.tint;
    weight += s.weight;
    seen += s.seen;
}

void MapFill::run(const MapRecord& record, std::span<const MapRecord* const> others, bool reflects,
                  BlockMap& map) {
    sums_.assign(grid_.texels, {});
    add_own(record);
    if (!others.empty()) find_nearest(record);
    for (const MapRecord* other : others) add_other(*other, record.anchor.position);
    map.anchor = record.anchor;
    map.footprint = record.footprint;
    map.center_x = record.center_x;
    map.center_y = record.center_y;
    map.size = record.size;
    map.resize(grid_, reflects);
    spread(record, map);
    map.finish(grid_);
}

/// Within a tile and around it, since a single ray per tile may miss what is in it.
void MapFill::find_nearest(const MapRecord& record) {
    own_ = &record;
    nearest_.assign(grid_.tiles, none);
    const auto keep_nearer = [&](std::uint32_t& at, std::uint32_t other) {
        if (other != none && (at == none || record.seen[other].distance < record.seen[at].distance))
            at = other;
    };
    for (std::uint32_t i = 0; i < record.seen.size(); ++i)
        keep_nearer(nearest_[record.seen[i].run.first / tile_texels], i);
    for (const auto& neighbors : {right_, below_}) {
        const std::vector<std::uint32_t> before = nearest_;
        for (std::size_t tile = 0; tile < grid_.tiles; ++tile) {
            const std::size_t other = neighbors[tile];
            keep_nearer(nearest_[tile], before[other]);
            keep_nearer(nearest_[other], before[tile]);
        }
    }
}

void MapFill::add_point(std::uint32_t texel, const SeenRadiance& seen, float weight) {
    Sum& sum = sums_[texel];
    sum.direct += seen.direct * weight;
    sum.indirect += seen.indirect * weight;
    sum.weight += weight;
    sum.seen += weight;
}

void MapFill::add_open(const OpenDirection& open) {
    Sum& sum = sums_[open.run.through];
    sum.tint += open.tint;
    sum.weight += 1;
}

void MapFill::add_own(const MapRecord& record) {
    for (const SeenRadiance& seen : record.seen) add_point(seen.run.through, seen, 1);
    for (const OpenDirection& open : record.open) add_open(open);
}

/// In which tiles a projected point or an open direction of `other` may be hidden from `eye`.
void MapFill::find_hidden(const MapRecord& other, Vec3 eye) {
    hides_.assign(grid_.tiles, 0);
    const float moves = length(other.anchor.position - eye) / most_parallax;  // nearer occluders do
    const auto occluder = [&](std::size_t tile) {
        const std::uint32_t i = nearest_[tile];
        return i != none && own_->seen[i].distance < moves ? i : none;
    };
    for (std::size_t i = 0; i < other.seen.size(); ++i) {
        const std::size_t tile = projected_.texels[i] / tile_texels;
        const std::uint32_t near = occluder(tile);
        if (near != none && lies_behind(*own_, near, other, i)) hides_[tile] = 1;
    }
    for (const OpenDirection& open : other.open) {
        const std::size_t tile = open.run.through / tile_texels;
        if (occluder(tile) != none) hides_[tile] = 1;
    }
}

void MapFill::add_other(const MapRecord& other, Vec3 eye) {
    project_points(grid_, other, eye, projected_);
    find_hidden(other, eye);
    for (std::size_t i = 0; i < other.seen.size(); ++i) {
        const std::uint32_t texel = projected_.texels[i];
        if (hides_[texel / tile_texels]) continue;
        const float growth = sqr(other.seen[i].distance) / std::max(projected_.distances2[i], 1e-30f);
        add_point(texel, other.seen[i], std::clamp(growth, 1 / most_growth, most_growth));
    }
    for (const OpenDirection& open : other.open)
        if (!hides_[open.run.through / tile_texels]) add_open(open);
}

MapFill::Sum MapFill::sum_of(std::uint32_t first, std::uint32_t count) const {
    Sum sum;
    for (std::uint32_t texel = first; texel < first + count; ++texel) sum.add(sums_[texel]);
    return sum;
}

void MapFill::spread(const MapRecord& record, BlockMap& map) const {
    for (const SeenRadiance& seen : record.seen) spread_run(seen.run, map);
    for (const OpenDirection& open : record.open) spread_run(open.run, map);
    for (std::uint32_t texel = 0; texel < grid_.texels; ++texel)
        if (sums_[texel].weight > 0 && !(map.known[texel / tile_texels] >> texel % tile_texels & 1))
            put(texel, sums_[texel], map);
}

/// Empty texels take what is in their quarter of the run, or else in all of it.
void MapFill::spread_run(TexelRun run, BlockMap& map) const {
    constexpr std::uint32_t quarter = 4;
    const Sum whole = sum_of(run.first, run.count);
    for (std::uint32_t first = run.first; first < run.first + std::uint32_t{run.count}; first += quarter) {
        const std::uint32_t count = std::min<std::uint32_t>(run.count, quarter);
        const Sum part = sum_of(first, count);
        const Sum& around = part.weight > 0 ? part : whole;
        for (std::uint32_t texel = first; texel < first + count; ++texel)
            put(texel, sums_[texel].weight > 0 ? sums_[texel] : around, map);
    }
}

void MapFill::put(std::uint32_t texel, const Sum& sum, BlockMap& map) const {
    const float share = 1 / sum.weight;
    map.direct.put(texel, (sum.direct + sum.tint * environment_.texels[texel]) * share);
    if (!map.indirect.empty()) map.indirect.put(texel, sum.indirect * share);
    const auto bit = static_cast<std::uint16_t>(1u << texel % tile_texels);
    map.known[texel / tile_texels] |= bit;
    if (sum.seen == 0 && sum.tint == Spectrum{sum.weight}) map.open[texel / tile_texels] |= bit;
}

void MapFill::distances(const MapRecord& record, std::vector<float>& out) const {
    out.assign(grid_.texels, infinity);
    for (const SeenRadiance& seen : record.seen)
        std::fill_n(out.begin() + seen.run.first, seen.run.count, seen.distance);
}

}  // namespace relumine
