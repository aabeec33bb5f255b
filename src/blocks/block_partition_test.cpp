// SPDX-License-Identifier: Apache-2.0
// Which samples share a map, and the error that decides it.
#include "blocks/block_partition.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "blocks/blend.hpp"
#include "blocks/map_fill.hpp"
#include "blocks/parallax.hpp"
#include "blocks/test_maps.hpp"

namespace relumine {
namespace {

using testing::even_sky;
using testing::gather_point;
using testing::MapStage;
using testing::open_map;
using testing::Quad;

constexpr float footprint = 0.05f;  // metres per pixel

ReceiverBsdf matte(Vec3 normal) {
    Vertex vertex{{}, {{0, 0, 1}}, Lambert{Spectrum{0.5f}}};
    vertex.point.frame = frame_around(normal);
    return *receiver_bsdf(vertex, {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}});
}

/// A cell's samples as cache points, and what they share.
struct Samples {
    std::vector<CachePoint> points;
    std::vector<BlockPoint> blocks;  // of the points

    void add(int x, int y, Vec3 position, Vec3 normal, std::uint32_t depth = 0) {
        GatherPoint gather = gather_point(position, normal);
        gather.depth = depth;
        points.push_back(
            {gather, x, y, footprint, hash(static_cast<std::uint64_t>(x), static_cast<std::uint64_t>(y))});
    }
    void finish() {
        for (const CachePoint& p : points) blocks.push_back({&p, matte(p.gather.frame.n)});
    }
};

Vec3 on_floor(int x, int y) {
    return {footprint * static_cast<float>(x), footprint * static_cast<float>(y), 0};
}

/// A floor seen from above.
Samples floor_of(int side) {
    Samples samples;
    for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x) samples.add(x, y, on_floor(x, y), {0, 0, 1});
    samples.finish();
    return samples;
}

/// A floor, a step, a slope, a body of another depth, and a ball's normals, side by side.
Samples many_surfaces() {
    Samples samples;
    for (int y = 0; y < cell_pixels; ++y)
        for (int x = 0; x < cell_pixels; ++x) {
            const Vec3 p = on_floor(x, y);
            if (x < 4)
                samples.add(x, y, p, {0, 0, 1});
            else if (x < 7)
                samples.add(x, y, p + Vec3{0, 0, 0.7f}, {0, 0, 1});
            else if (x < 9)
                samples.add(x, y, p, {0, 0, 1}, 2);
            else if (y < 8)
                samples.add(x, y, p + Vec3{0, 0, p.x}, normalize({-1, 0, 1}));
            else
                samples.add(x, y, p, normalize({p.x - 0.6f, p.y - 0.6f, 0.2f}));
        }
    samples.finish();
    return samples;
}

constexpr PixelRect cell{0, 0, cell_pixels, cell_pixels};

std::vector<BlockMap> maps_of(const MapStage& stage, const Samples& samples, BlockSettings settings = {}) {
    const FlushDenormals flush;
    RayCounts rays;
    std::vector<BlockMap> maps;
    MapFill fill(stage.grid(), stage.environment());
    for (const MapRecord& record : make_records(stage.source(), cell, samples.blocks, settings, rays))
        if (record.has_map) fill.run(record, {}, false, maps.emplace_back());
    return maps;
}

Blend blend_of(const CachePoint& point, const std::vector<BlockMap>& maps) {
    std::vector<const BlockMap*> candidates;
    for (const BlockMap& map : maps) candidates.push_back(&map);
    return blend_maps(point, candidates);
}

const Quad wall_beside_floor{{0.1f, -5, 0}, {0, 0, 5}, {0, 10, 0}, Spectrum{4, 1, 1}};

TEST(BlockPartition, EverySampleFindsAMapOfItsCell) {
    const MapStage stage({wall_beside_floor}, even_sky(Spectrum{1}), 16);
    const Samples samples = many_surfaces();
    for (const int largest : {16, 8, 4}) {
        BlockSettings settings;
        settings.largest = largest;
        const std::vector<BlockMap> maps = maps_of(stage, samples, settings);
        for (const CachePoint& p : samples.points) {
            const Blend blend = blend_of(p, maps);
            ASSERT_FALSE(blend.empty()) << p.x << " " << p.y;
            for (const auto& [map, weight] : blend.maps()) {
                EXPECT_EQ(map->anchor.depth, p.gather.depth);
                EXPECT_GT(dot(map->anchor.frame.n, p.gather.frame.n), 0.8f);
            }
        }
    }
}

bool same(const std::vector<BlockMap>& a, const std::vector<BlockMap>& b) {
    return std::ranges::equal(a, b, [](const BlockMap& m, const BlockMap& n) {
        return m.direct.texels == n.direct.texels && m.known == n.known && m.size == n.size
               && m.center_x == n.center_x && m.anchor.position == n.anchor.position;
    });
}

TEST(BlockPartition, LooksAtTheSamplesOfItsCellAlone) {
    const MapStage stage({wall_beside_floor}, even_sky(Spectrum{1}), 16);
    Samples wider, alone;
    for (int y = -4; y < cell_pixels + 4; ++y)
        for (int x = -4; x < cell_pixels + 4; ++x) {
            wider.add(x, y, on_floor(x, y), {0, 0, 1});
            if (x >= 0 && y >= 0 && x < cell_pixels && y < cell_pixels)
                alone.add(x, y, on_floor(x, y), {0, 0, 1});
        }
    wider.finish();
    alone.finish();
    const auto maps = maps_of(stage, alone);
    EXPECT_GT(maps.size(), 1u);
    EXPECT_TRUE(same(maps, maps_of(stage, alone)));
    EXPECT_TRUE(same(maps, maps_of(stage, wider)));
}

TEST(BlockPartition, OneMapDoesUnderTheSkyAlone) {
    const MapStage stage({}, even_sky(Spectrum{1}), 16);
    const auto maps = maps_of(stage, floor_of(cell_pixels));
    ASSERT_EQ(maps.size(), 1u);
    EXPECT_EQ(maps[0].size, cell_pixels);
    EXPECT_EQ(maps[0].center_x, 8);
}

TEST(BlockPartition, SplitsWhereSurfacesMeet) {
    const MapStage stage({wall_beside_floor}, even_sky(Spectrum{1}), 32);
    BlockSettings fine;
    fine.smallest = 1;
    const auto maps = maps_of(stage, floor_of(cell_pixels), fine);
    EXPECT_GT(maps.size(), 4u);
    float near = infinity,
          far = 0;  // the sides of the smallest block at the wall and of the largest away from it
    for (const BlockMap& map : maps) {
        const float to_wall = std::abs(map.center_x - 0.1f / footprint);
        if (to_wall < 2) near = std::min(near, map.size);
        if (to_wall > 7) far = std::max(far, map.size);
    }
    EXPECT_LT(near, far);
    BlockSettings coarse;
    coarse.smallest = 8;
    for (const BlockMap& map : maps_of(stage, floor_of(cell_pixels), coarse)) EXPECT_GE(map.size, 8);
    BlockSettings loose;
    loose.tolerance = 1000;
    EXPECT_EQ(maps_of(stage, floor_of(cell_pixels), loose).size(), 1u);
}

TEST(BlockPartition, NoGroupHasMoreRaysThanAreAllowed) {
    const MapStage stage({wall_beside_floor}, even_sky(Spectrum{1}), 64);
    const Samples samples = floor_of(cell_pixels);
    const auto most = [&](float allowed) {
        const FlushDenormals flush;
        BlockSettings settings;
        settings.most_rays = allowed;
        RayCounts rays;
        std::size_t found = 0;
        for (const MapRecord& r : make_records(stage.source(), cell, samples.blocks, settings, rays))
            found = std::max(found, r.seen.size() + r.open.size());
        return found;
    };
    EXPECT_GT(most(10000), 1500u);
    EXPECT_LT(most(400), 1000u);  // tiles have 1, 4 or 16
}

/// Where a block is divided, what its rays have met is kept, but no map is made of it.
TEST(BlockPartition, DividedBlocksLeaveTheirRecords) {
    const FlushDenormals flush;
    const MapStage stage({wall_beside_floor}, even_sky(Spectrum{1}), 32);
    const Samples samples = floor_of(cell_pixels);
    BlockSettings settings;
    RayCounts rays;
    const auto records = make_records(stage.source(), cell, samples.blocks, settings, rays);
    std::size_t kept = 0, divided = 0;
    for (const MapRecord& r : records) {
        kept += r.seen.size() + r.open.size();
        divided += !r.has_map;
    }
    EXPECT_GT(divided, 0u);
    EXPECT_EQ(kept, rays.by_purpose[static_cast<std::size_t>(RayPurpose::record)]);
    EXPECT_EQ(maps_of(stage, samples).size(), records.size() - divided);
}

TEST(BlockPartition, StaysWithinItsBytes) {
    const FlushDenormals flush;
    const MapStage stage({wall_beside_floor}, even_sky(Spectrum{1}), 32);
    const Samples samples = floor_of(cell_pixels);
    const auto map_bytes = static_cast<double>(BlockMap::bytes(stage.source().grid, false));
    std::size_t before = 1000;
    for (const double most : {1e9, 1e6, 3e5, 1e5, 0.0}) {
        BlockSettings settings;
        settings.smallest = 1;
        settings.most_bytes = most;
        RayCounts rays;
        const auto records = make_records(stage.source(), cell, samples.blocks, settings, rays);
        double bytes = 0;
        for (const MapRecord& r : records)
            bytes += static_cast<double>(r.bytes()) + (r.has_map ? map_bytes : 0);
        EXPECT_LE(bytes, most);
        EXPECT_LT(records.size(), before) << most;
        EXPECT_EQ(records.empty(), most == 0) << most;
        before = records.size();
    }
}

TEST(BlockPartition, AnEmptyCellHasNoMaps) {
    const MapStage stage({}, even_sky(Spectrum{1}), 16);
    EXPECT_TRUE(maps_of(stage, {}).empty());
}

class Parallax : public ::testing::Test {
  protected:
    const DirectionGrid grid{32};
    const BlockMap striped =
        open_map(grid, [](std::size_t texel) { return Spectrum{texel % 3 == 0 ? 4.0f : 1.0f}; });
    const std::vector<float> weights = std::vector<float>(grid.tiles, 0.3f);
    const std::vector<float> near = std::vector<float>(grid.texels, 2.0f);

    [[nodiscard]] float error(const BlockMap& map, const std::vector<float>& distances,
                              float displacement) const {
        return parallax_error(grid, map, distances, weights, displacement, 0);
    }
};

TEST_F(Parallax, IsNoneWhereNothingMovesOrNothingIsNear) {
    EXPECT_EQ(error(striped, near, 0), 0);
    EXPECT_EQ(error(striped, std::vector<float>(grid.texels, infinity), 1), 0);
    const BlockMap even = open_map(grid, [](std::size_t) { return Spectrum{2}; });
    EXPECT_NEAR(error(even, near, 1), 0, 1e-6f);
}

TEST_F(Parallax, GrowsWithTheDisplacementUntilWholeTexelsAreSwept) {
    float before = 0;
    const float side = std::sqrt(grid.texel_solid_angle);
    for (float displacement = 0.01f; displacement < 2 * side * 0.99f; displacement += 0.01f) {
        const float now = error(striped, near, displacement);
        ASSERT_GT(now, before);
        ASSERT_NEAR(now, displacement * error(striped, near, 0.01f) / 0.01f, 1e-3f * now);  // in proportion
        before = now;
    }
    EXPECT_EQ(error(striped, near, 3 * side), error(striped, near, 5 * side));
    EXPECT_LT(error(striped, std::vector<float>(grid.texels, 4.0f), 0.1f), error(striped, near, 0.1f));
}

/// A dark plate hides nine tenths of the sky from the anchor, as a lamp's back does under a ceiling. Whoever
/// is farther away than it is sees the sky: what is near does not move by a texel, it goes.
TEST_F(Parallax, WhatIsNearGoesAltogether) {
    std::vector<float> distances(grid.texels, infinity);
    const auto hidden = [](std::size_t texel) { return texel % 10 != 0; };
    for (std::size_t texel = 0; texel < grid.texels; ++texel)
        if (hidden(texel)) distances[texel] = 0.01f;
    const BlockMap map =
        open_map(grid, [&](std::size_t texel) { return Spectrum{hidden(texel) ? 0.2f : 1.0f}; });
    const float edges = error(map, distances, 0.009f);
    EXPECT_NEAR(error(map, distances, 1) - edges, 0.9 * 0.8 * 0.99 / (0.9 * 0.2 + 0.1), 0.02);
    const BlockMap wall = open_map(grid, [](std::size_t) { return Spectrum{1}; });
    EXPECT_NEAR(error(wall, distances, 1), 0, 1e-5f);  // beside a wall as bright as the room
}

/// One lit texel: four edges of length s each sweep s·d/r, of what the sky of weight 1 reflects.
TEST_F(Parallax, IsWhatTheEdgesSweep) {
    const std::size_t lit = grid.texel_at({normalize({0.2f, 0.3f, 0.9f})});
    const BlockMap map =
        open_map(grid, [&](std::size_t texel) { return Spectrum{texel == lit ? 11.0f : 1.0f}; });
    const float side = std::sqrt(grid.texel_solid_angle), displacement = 0.02f;
    const double swept = 4 * 10 * side * displacement / 2;
    const double reflected = 4 * pi + 10 * grid.texel_solid_angle;
    EXPECT_NEAR(error(map, near, displacement), swept / reflected, 1e-4 * swept);
    const float floored = parallax_error(grid, map, near, weights, displacement, 10);
    EXPECT_NEAR(floored, swept / (10 * 4 * pi), 1e-4 * swept);
}

}  // namespace
}  // namespace relumine
