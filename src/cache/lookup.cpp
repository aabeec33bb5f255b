// SPDX-License-Identifier: Apache-2.0
// The index of records.
#include "cache/lookup.hpp"

#include <algorithm>
#include <cmath>

namespace relumine {
namespace {

/// How far behind a record's surface a point may lie, of its distance: curved surfaces are no planes.
constexpr float greatest_step = 0.1f;

}  // namespace

bool is_behind(Vec3 offset, Vec3 record_normal, Vec3 normal) {
    return 0.5f * dot(offset, record_normal + normal) < -greatest_step * length(offset);
}

float unsuitability(const CacheEntry& entry, const Query& query, const ReuseLimits& limits) {
    const Record& record = entry.record;
    const float distance2 = length_squared(record.position - query.receiver.position);
    const float cosine = dot(record.frame.n, query.receiver.frame.n);
    if (distance2 > sqr(record.reach) || cosine < limits.min_cos_normals) return infinity;
    if (std::abs(entry.x - query.x) > entry.pixel_reach || std::abs(entry.y - query.y) > entry.pixel_reach)
        return infinity;
    if (is_behind(query.receiver.position - record.position, record.frame.n, query.receiver.frame.n))
        return infinity;
    return distance2 / sqr(record.reach) + (1 - cosine) / (1 - limits.min_cos_normals);
}

void RadianceCache::add(CacheEntry&& entry) {
    const auto number = static_cast<std::uint32_t>(entries_.size());
    spheres_.add(number, entry.record.position, entry.record.reach);
    entries_.push_back(std::make_unique<const CacheEntry>(std::move(entry)));
}

void RadianceCache::collect(const Query& query, const ReuseLimits& limits,
                            std::vector<FoundRecord>& found) const {
    spheres_.for_each_near(query.receiver.position, [&](std::uint32_t number) {
        const CacheEntry& entry = *entries_[number];
        if (const float bad = unsuitability(entry, query, limits); bad < infinity)
            found.push_back({&entry, first_id_ + number, bad});
    });
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
