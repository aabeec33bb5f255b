// SPDX-License-Identifier: Apache-2.0
// Finding records that may stand in for a point's own view [V, §3.1].
#pragma once

#include <memory>
#include <span>

#include "cache/record.hpp"
#include "cache/reproject.hpp"
#include "cache/sphere_index.hpp"

namespace relumine {

/// A record in the cache, with where it came from.
struct CacheEntry {
    Record record;
    int x = 0, y = 0;     // pixel, full frame
    int pixel_reach = 0;  // pixels: how far from there it may be used, along each axis
};

/// When a record may be used.
struct ReuseLimits {
    float min_cos_normals = 0.9f;  // between geometric normals
    int records_per_point = 3;     // M
};

struct Query {
    Receiver receiver;
    int x = 0, y = 0;  // pixel, full frame
};

/// Whether a point at `offset` from a record lies behind what it has seen [Ward88]: below its surface, as a
/// floor lies below the box that stands on it. What is there the record knows nothing of, not even that it
/// does not.
[[nodiscard]] bool is_behind(Vec3 offset, Vec3 record_normal, Vec3 normal);

/// How badly a record suits, from 0 where it is at the point itself; infinite where it must not be used.
[[nodiscard]] float unsuitability(const CacheEntry& entry, const Query& query, const ReuseLimits& limits);

struct FoundRecord {
    const CacheEntry* entry;
    std::uint32_t id;
    float unsuitability;
};

/// Records by the spheres that they reach. Adding is for one thread; any number may look up at a time.
class RadianceCache {
  public:
    /// Records are numbered from `first_id` on, in the order in which they are added.
    explicit RadianceCache(std::uint32_t first_id = 0) : first_id_(first_id) {}

    void add(CacheEntry&& entry);
    [[nodiscard]] std::size_t size() const { return entries_.size(); }

    /// Appends every record that may be used, in no particular order.
    void collect(const Query& query, const ReuseLimits& limits, std::vector<FoundRecord>& found) const;

  private:
    std::uint32_t first_id_;
    std::vector<std::unique_ptr<const CacheEntry>> entries_;
    SphereIndex spheres_;  // by index of entries_
};

/// The most suitable records of all caches, best first, at most limits.records_per_point; equal ones in order
/// of id, so that the order of insertion cannot show.
void find_records(std::span<const RadianceCache* const> caches, const Query& query, const ReuseLimits& limits,
                  std::vector<FoundRecord>& found);

}  // namespace relumine
