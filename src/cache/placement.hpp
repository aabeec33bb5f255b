// SPDX-License-Identifier: Apache-2.0
// Where records are made: level by level over the image, so that neither threads nor tiles nor crops show.
#pragma once

#include <functional>

#include "base/cache_counts.hpp"
#include "base/memory.hpp"
#include "cache/lookup.hpp"
#include "relumine/image.hpp"

namespace relumine {

struct CacheSettings {
    RecordSettings record;
    ReuseLimits reuse;
    float spacing = 1;  // factor on how far records reach
    int gap_cell = 4;   // k: bits along each side of the cells that share a gap ray
    float enough_gaps =
        0.25f;  // share of bits without radiance below which no further record is tried: each one
                // costs as much as its gap rays and darkens a little (docs/paper-reproduction.md)
    float most_gaps = 0.15f;  // share above which records do not do: the point makes its own, if it may
};

/// A point that may borrow or make a record.
struct CachePoint {
    GatherPoint gather;
    int x = 0, y = 0;       // pixel, full frame
    float footprint = 0;    // metres that a pixel covers there
    std::uint64_t key = 0;  // of the record that the point would make
};

/// Pixels between lattice points of the levels, coarse to fine; lattices are anchored at pixel (0, 0).
inline constexpr std::array<int, 6> level_spacings{32, 16, 8, 4, 2, 1};

/// A record may be used this many spacings of its level away.
inline constexpr int reach_in_spacings = 2;

/// How far the placement at a pixel can depend on others, pixels: a crop needs such a border to place as the
/// whole does.
inline constexpr int placement_halo = 2 * (32 + 16 + 8 + 4 + 2 + 1);

/// How far a record at the point may reach, metres: bounded from below and above in pixels, because the one
/// costs records and the other shows.
[[nodiscard]] ReachLimits reach_limits(const CachePoint& point, const CacheSettings& settings);

/// Makes the record that `point` asks for.
[[nodiscard]] CacheEntry make_entry(const IncidentRadiance& source, const CachePoint& point, int pixel_reach,
                                    const CacheSettings& settings, RayCounts& rays, CacheCounts& counts);

/// Reprojects the found records one after the other until few gaps are left. The share of bits that are.
float cover(std::span<const FoundRecord> found, const Receiver& receiver, const CacheSettings& settings,
            bool with_direct, Reprojection& out, CacheCounts& counts);

/// What placement counts and asks.
struct PlacementRun {
    int threads = 1;
    std::function<bool()> stop;  // asked often; true: come to an end soon
    RayCounts rays;
    CacheCounts counts;
    std::uint64_t room = no_limit;  // bytes that new records may take; fine levels come last and go without
};

/// Adds records to `added` for the pixels of `region` until every point has one that it may use, from `kept`
/// or `added`. Each level decides in parallel against the coarser ones and adds in order of pixels.
/// `point_at` gives the points; null: none there.
/// Where run.room does not suffice, points are left without; which ones, threads do not decide.
void place_records(const IncidentRadiance& source, const PixelRect& region,
                   const std::function<const CachePoint*(int x, int y)>& point_at,
                   const CacheSettings& settings, const RadianceCache& kept, RadianceCache& added,
                   PlacementRun& run);

}  // namespace relumine
