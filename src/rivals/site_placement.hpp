// SPDX-License-Identifier: Apache-2.0
// Where records are made, before the picture is: level by level over the frame, so that threads do not show.
#pragma once

#include <functional>

#include "base/cache_counts.hpp"
#include "relumine/image.hpp"
#include "rivals/polar_hemisphere.hpp"
#include "rivals/sites.hpp"

namespace relumine {

/// What a method keeps at sites.
struct SiteMaker {
    std::function<void(std::size_t count)> grow;  // makes room for so many records in all
    /// Makes the record of this number; any number of threads at a time, each another record.
    std::function<Site(std::size_t id, const SitePoint&, RayCounts&, CacheCounts&)> make;
};

/// What placement counts and asks.
struct SiteRun {
    int threads = 1;
    std::function<bool()> stop;  // asked often; true: come to an end soon
    RayCounts rays;
    CacheCounts counts;
};

/// Adds sites until every point of the frame has one that it may use with an error below `share` of the
/// accuracy. Lattices of 32, 16 … 1 pixels, anchored at pixel (0, 0): each decides in parallel against the
/// sites of those before and adds in order of pixels. Where clamping has left points without a site, the last
/// is gone over again, a few times. `point_at` gives the points; null: none there.
void place_sites(const PixelRect& frame, const std::function<const SitePoint*(int x, int y)>& point_at,
                 float share, const SiteMaker& maker, Sites& sites, SiteRun& run);

}  // namespace relumine
