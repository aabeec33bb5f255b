// SPDX-License-Identifier: Apache-2.0
// Spheres by place: which of them may a point lie in?
#pragma once

#include <cstdint>
#include <unordered_map>
#include <vector>

#include "base/vec.hpp"

namespace relumine {

/// Grids of cells of 2^level metres, each sphere in the up to eight cells that it touches at the level where
/// cells are as wide as itself. Adding is for one thread; any number may look up at a time.
class SphereIndex {
  public:
    void add(std::uint32_t id, Vec3 center, float radius);

    /// Calls use(id) for every sphere that contains the point and some that do not; in an order that depends
    /// on nothing but what was added.
    template <typename Use>
    void for_each_near(Vec3 position, const Use& use) const {
        for (const int level : levels_) {
            const auto ids = cells_.find(key_of(cell_at(position, level), level));
            if (ids == cells_.end()) continue;
            for (const std::uint32_t id : ids->second) use(id);
        }
    }

  private:
    struct Cell {
        std::int64_t x, y, z;
    };
    [[nodiscard]] static Cell cell_at(Vec3 p, int level);
    [[nodiscard]] static std::uint64_t key_of(const Cell& cell, int level);

    std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> cells_;
    std::vector<int> levels_;  // in use, ascending
};

}  // namespace relumine
