// SPDX-License-Identifier: Apache-2.0
// Cells of spheres.
#include "cache/sphere_index.hpp"

#include <algorithm>
#include <cmath>

#include "base/hash.hpp"

namespace relumine {
namespace {

/// The least level whose cells are as wide as the sphere of this radius.
int level_of(float radius) {
    int level = 0;
    std::frexp(2 * radius, &level);
    return level;
}

}  // namespace

SphereIndex::Cell SphereIndex::cell_at(Vec3 p, int level) {
    const auto along = [&](float c) { return static_cast<std::int64_t>(std::floor(std::ldexp(c, -level))); };
    return {along(p.x), along(p.y), along(p.z)};
}

/// Cells of different places may share a key: their spheres are then looked at in vain.
std::uint64_t SphereIndex::key_of(const Cell& cell, int level) {
    return hash(static_cast<std::uint64_t>(level + 1024), static_cast<std::uint64_t>(cell.x), cell.y, cell.z);
}

void SphereIndex::add(std::uint32_t id, Vec3 center, float radius) {
    const int level = level_of(radius);
    const auto place = std::lower_bound(levels_.begin(), levels_.end(), level);
    if (place == levels_.end() || *place != level) levels_.insert(place, level);
    const Vec3 half_extent{radius, radius, radius};
    const Cell first = cell_at(center - half_extent, level), last = cell_at(center + half_extent, level);
    for (std::int64_t z = first.z; z <= last.z; ++z)
        for (std::int64_t y = first.y; y <= last.y; ++y)
            for (std::int64_t x = first.x; x <= last.x; ++x) cells_[key_of({x, y, z}, level)].push_back(id);
}

}  // namespace relumine
