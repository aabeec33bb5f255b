// SPDX-License-Identifier: Apache-2.0
// The index of records.
#include "cache/lookup.hpp"

#include <algorithm>
#include <cmath>

#include "base/hash.hpp"

namespace relumine {
namespace {

/// How far behind a record's surface a point may lie, of its distance: curved surfaces are no planes.
constexpr float greatest_step = 0.1f;

struct CellIndex {
    std::int64_t x, y, z;
};

CellIndex cell_at(Vec3 p, int level) {
    const auto along = [&](float c) { return static_cast<std::int64_t>(std::floor(std::ldexp(c, -level))); };
    return {along(p.x), along(p.y), along(p.z)};
}

/// Cells of different places may share a key: their entries are then looked at in vain.
std::uint64_t key_of(const CellIndex& cell, int level) {
    return hash(static_cast<std::uint64_t>(level + 1024), static_cast<std::uint64_t>(cell.x), cell.y, cell.z);
}

/// The least level whose cells are as wide as the sphere of this radius.
int level_of(float radius) {
    int level = 0;
    std::frexp(2 * radius, &level);
    return level;
}

/// Whether the point lies behind what the record has seen [Ward88]: below its surface, as a floor lies below
/// the box that stands on it. What is there the record knows nothing of, not even that it does not.
bool is_behind(const Record& record, const Receiver& receiver, float distance) {
    const Vec3 normal = record.frame.n + receiver.frame.n;
    return 0.5f * dot(receiver.position - record.position, normal) < -greatest_step * distance;
}

}  // namespace

float unsuitability(const CacheEntry& entry, const Query& query, const ReuseLimits& limits) {
    const Record& record = entry.record;
    const float distance2 = length_squared(record.position - query.receiver.position);
    const float cosine = dot(record.frame.n, query.receiver.frame.n);
    if (distance2 > sqr(record.reach) || cosine < limits.min_cos_normals) return infinity;
    if (std::abs(entry.x - query.x) > entry.pixel_reach || std::abs(entry.y - query.y) > entry.pixel_reach)
        return infinity;
    if (is_behind(record, query.receiver, std::sqrt(distance2))) return infinity;
    return distance2 / sqr(record.reach) + (1 - cosine) / (1 - limits.min_cos_normals);
}

void RadianceCache::add(CacheEntry&& entry) {
    const auto number = static_cast<std::uint32_t>(entries_.size());
    const Vec3 p = entry.record.position;
    const float reach = entry.record.reach;
    entries_.push_back(std::make_unique<const CacheEntry>(std::move(entry)));
    const int level = level_of(reach);
    const auto place = std::lower_bound(levels_.begin(), levels_.end(), level);
    if (place == levels_.end() || *place != level) levels_.insert(place, level);
    const Vec3 half_extent{reach, reach, reach};
    const CellIndex first = cell_at(p - half_extent, level), last = cell_at(p + half_extent, level);
    for (std::int64_t z = first.z; z <= last.z; ++z)
        for (std::int64_t y = first.y; y <= last.y; ++y)
            for (std::int64_t x = first.x; x <= last.x; ++x)
                cells_[key_of({x, y, z}, level)].push_back(number);
}

void RadianceCache::collect(const Query& query, const ReuseLimits& limits,
                            std::vector<FoundRecord>& found) const {
    for (const int level : levels_) {
        const auto cell = cells_.find(key_of(cell_at(query.receiver.position, level), level));
        if (cell == cells_.end()) continue;
        for (const std::uint32_t number : cell->second) {
            const CacheEntry& entry = *entries_[number];
            if (const float bad = unsuitability(entry, query, limits); bad < infinity)
                found.push_back({&entry, first_id_ + number, bad});
        }
    }
}

void find_records(std::span<const RadianceCache* const> caches, const Query& query, const ReuseLimits& limits,
                  std::vector<FoundRecord>& found) {
    found.clear();
    for (const RadianceCache* cache : caches) cache->collect(query, limits, found);
    const auto wanted = std::min(static_cast<std::size_t>(limits.records_per_point), found.size());
    const auto better = [](const FoundRecord& a, const FoundRecord& b) {
        return a.unsuitability != b.unsuitability ? a.unsuitability < b.unsuitability : a.id < b.id;
    };
    std::partial_sort(found.begin(), found.begin() + static_cast<std::ptrdiff_t>(wanted), found.end(),
                      better);
    found.resize(wanted);
}

}  // namespace relumine
