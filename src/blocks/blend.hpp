// SPDX-License-Identifier: Apache-2.0
// Which maps a camera sample is lit by, and with which weights.
#pragma once

#include <array>
#include <span>

#include "blocks/block_map.hpp"
#include "cache/placement.hpp"

namespace relumine {

struct WeightedMap {
    const BlockMap* map;
    float weight;
};

/// Few maps whose weights add up to 1.
class Blend {
  public:
    static constexpr std::size_t most = 8;

    [[nodiscard]] std::span<const WeightedMap> maps() const { return {maps_.data(), count_}; }
    [[nodiscard]] bool empty() const { return count_ == 0; }
    /// The side of the smallest map's block, pixels.
    [[nodiscard]] float smallest_block() const;
    /// Keeps the heaviest.
    void add(const BlockMap& map, float weight);
    void normalize();
    /// Of the maps the one that weighs most, by 1.
    void keep_heaviest();

  private:
    std::array<WeightedMap, most> maps_{};
    std::size_t count_ = 0;
};

/// The maps around `point` among `candidates`, weighed by tents that reach one block's side from its middle
/// and by how well normals and planes agree: a partition of unity in which no block's border shows.
[[nodiscard]] Blend blend_maps(const CachePoint& point, std::span<const BlockMap* const> candidates);

}  // namespace relumine
