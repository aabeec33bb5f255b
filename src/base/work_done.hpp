// SPDX-License-Identifier: Apache-2.0
// What a render has done so far, for statistics that survive an interruption.
#pragma once

#include <tuple>

#include "base/tile.hpp"

namespace relumine {

struct WorkDone {
    RayCounts rays;
    CacheCounts cache;
    std::uint64_t non_finite = 0;  // samples dropped
    std::optional<SampleId> first_non_finite;
    double seconds = 0;  // wall clock

    void add(const Tile& tile) {
        rays.add(tile.rays);
        cache.add(tile.cache);
        add(tile.non_finite, tile.first_non_finite);
    }
    /// Keeps the first in order of sample, row, column, so that it does not depend on which thread was first.
    void add(std::uint64_t dropped, const std::optional<SampleId>& first) {
        non_finite += dropped;
        const auto order = [](const SampleId& s) { return std::tuple(s.sample, s.y, s.x); };
        if (first && (!first_non_finite || order(*first) < order(*first_non_finite)))
            first_non_finite = first;
    }
};

}  // namespace relumine
