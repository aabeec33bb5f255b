// SPDX-License-Identifier: Apache-2.0
// Stages and made-up maps for the tests of blocks.
#pragma once

#include "base/hash.hpp"
#include "blocks/block_trace.hpp"
#include "cache/placement.hpp"
#include "cache/test_stage.hpp"

namespace relumine::testing {

inline float uniform(std::uint64_t i, std::uint64_t what, float low = 0, float high = 1) {
    return low + (high - low) * unit_float(static_cast<std::uint32_t>(hash(i, what)));
}

inline WorldDir random_direction(std::uint64_t i, std::uint64_t what) {
    const float z = uniform(i, what, -1, 1), phi = uniform(i, what + 1, 0, 2 * pi), r = std::sqrt(1 - z * z);
    return {{r * std::cos(phi), r * std::sin(phi), z}};
}

/// A stage with what tracing its maps takes.
class MapStage {
  public:
    MapStage(const std::vector<Quad>& quads, const Environment& sky, int side, float bright_factor = 128)
        : stage_(quads, sky),
          split_(stage_.scene(), bright_factor),
          grid_(side),
          environment_(stage_.transport(), split_, grid_, 1) {}

    [[nodiscard]] MapSource source() const { return {stage_.source(), split_, grid_, environment_}; }
    [[nodiscard]] const DirectionGrid& grid() const { return grid_; }
    [[nodiscard]] const DimEnvironment& environment() const { return environment_; }
    [[nodiscard]] const Transport& transport() const { return stage_.transport(); }

  private:
    Stage stage_;
    BrightSplit split_;
    DirectionGrid grid_;
    DimEnvironment environment_;
};

inline GatherPoint gather_point(Vec3 position, Vec3 normal) {
    return {position, frame_around(normal), 1e-5f, 0};
}

/// A map that knows every texel, all of them open, with the given radiance by texel.
template <typename Radiance>
BlockMap open_map(const DirectionGrid& grid, const Radiance& radiance) {
    BlockMap map;
    map.anchor = gather_point({}, {0, 0, 1});
    map.size = 8;
    map.direct.resize(grid);
    for (std::size_t texel = 0; texel < grid.texels; ++texel) map.direct.put(texel, radiance(texel));
    map.known.assign(grid.tiles, whole_tile);
    map.open.assign(grid.tiles, whole_tile);
    map.finish(grid);
    return map;
}

/// Maps with holes, some of it open.
inline BlockMap random_map(const DirectionGrid& grid, std::uint64_t seed, bool with_indirect = true) {
    BlockMap map;
    map.anchor = gather_point({}, {0, 0, 1});
    map.size = 8;
    map.direct.resize(grid);
    if (with_indirect) map.indirect.resize(grid);
    for (std::size_t tile = 0; tile < grid.tiles; ++tile) {
        const auto bits = static_cast<std::uint16_t>(hash(tile, seed));
        map.known.push_back(hash(tile, seed + 1) % 3 != 0   ? whole_tile
                            : hash(tile, seed + 2) % 4 == 0 ? std::uint16_t{0}
                                                            : bits);
        map.open.push_back(static_cast<std::uint16_t>(hash(tile, seed + 3)) & map.known.back());
    }
    for (std::size_t texel = 0; texel < grid.texels; ++texel) {
        if (!(map.known[texel / tile_texels] >> texel % tile_texels & 1)) continue;
        const auto random = [&](std::uint64_t what) { return uniform(texel, hash(seed, what), 0.1f, 3); };
        map.direct.put(texel, {random(4), random(5), random(6)});
        if (with_indirect) map.indirect.put(texel, {random(7), random(8), random(9)});
    }
    map.finish(grid);
    return map;
}

}  // namespace relumine::testing
