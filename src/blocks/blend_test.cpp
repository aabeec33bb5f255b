// SPDX-License-Identifier: Apache-2.0
// Weighing maps: a partition of unity without borders, edge-stopped by normal, plane and depth.
#include "blocks/blend.hpp"

#include <gtest/gtest.h>

#include <map>

#include "blocks/test_maps.hpp"

namespace relumine {
namespace {

using testing::gather_point;

constexpr float footprint = 0.01f;  // metres per pixel

BlockMap block(float center_x, float center_y, float size, Vec3 normal = {0, 0, 1}) {
    BlockMap map;
    map.anchor = gather_point({center_x * footprint, center_y * footprint, 0}, normal);
    map.center_x = center_x;
    map.center_y = center_y;
    map.size = size;
    return map;
}

CachePoint pixel(int x, int y) {
    const Vec3 position{(static_cast<float>(x) + 0.5f) * footprint,
                        (static_cast<float>(y) + 0.5f) * footprint, 0};
    return {gather_point(position, {0, 0, 1}), x, y, footprint, 0};
}

std::vector<const BlockMap*> pointers(const std::vector<BlockMap>& maps) {
    std::vector<const BlockMap*> all;
    for (const BlockMap& map : maps) all.push_back(&map);
    return all;
}

std::map<const BlockMap*, float> weights(const Blend& blend) {
    std::map<const BlockMap*, float> by_map;
    for (const auto& [map, weight] : blend.maps()) by_map[map] = weight;
    return by_map;
}

float sum(const Blend& blend) {
    float all = 0;
    for (const WeightedMap& m : blend.maps()) all += m.weight;
    return all;
}

/// Blocks of 64 pixels, one of them in quarters.
std::vector<BlockMap> divided_frame() {
    std::vector<BlockMap> maps;
    for (int y = 0; y < 3; ++y)
        for (int x = 0; x < 3; ++x) {
            const float cx = 32 + 64 * static_cast<float>(x), cy = 32 + 64 * static_cast<float>(y);
            if (x != 1 || y != 1) {
                maps.push_back(block(cx, cy, 64));
                continue;
            }
            for (const float dx : {-16.0f, 16.0f})
                for (const float dy : {-16.0f, 16.0f}) maps.push_back(block(cx + dx, cy + dy, 32));
        }
    return maps;
}

TEST(Blend, WeightsAddUpToOneAndChangeSlowlyOverBorders) {
    const std::vector<BlockMap> maps = divided_frame();
    const auto candidates = pointers(maps);
    for (const int y : {40, 63, 64, 90, 127, 130}) {
        auto before = weights(blend_maps(pixel(0, y), candidates));
        for (int x = 1; x < 192; ++x) {
            const Blend blend = blend_maps(pixel(x, y), candidates);
            ASSERT_FALSE(blend.empty());
            ASSERT_NEAR(sum(blend), 1, 1e-5f);
            auto now = weights(blend);
            for (const BlockMap& map : maps)
                ASSERT_LT(std::abs(now[&map] - before[&map]), 0.07f) << x << " " << y;
            before = now;
        }
    }
}

TEST(Blend, TheHeaviestLightsAlone) {
    const std::vector<BlockMap> maps{block(4.5f, 8.5f, 16), block(10.5f, 8.5f, 16), block(20.5f, 8.5f, 16)};
    Blend blend = blend_maps(pixel(9, 8), pointers(maps));
    ASSERT_GT(blend.maps().size(), 1u);
    blend.keep_heaviest();
    ASSERT_EQ(blend.maps().size(), 1u);
    EXPECT_EQ(blend.maps()[0].map, &maps[1]);
    EXPECT_EQ(blend.maps()[0].weight, 1);
    Blend none;
    none.keep_heaviest();
    EXPECT_TRUE(none.empty());
}

TEST(Blend, TheMiddleOfABlockIsItsOwn) {
    std::vector<BlockMap> maps;
    for (const float x : {4.5f, 12.5f, 20.5f})
        for (const float y : {4.5f, 12.5f, 20.5f}) maps.push_back(block(x, y, 8));
    const Blend blend = blend_maps(pixel(12, 12), pointers(maps));
    ASSERT_EQ(blend.maps().size(), 1u);
    EXPECT_EQ(blend.maps()[0].map, &maps[4]);
    const Blend corner = blend_maps(pixel(8, 8), pointers(maps));  // as far from four middles
    ASSERT_EQ(corner.maps().size(), 4u);
    for (const WeightedMap& m : corner.maps()) EXPECT_NEAR(m.weight, 0.25f, 1e-5f);
}

TEST(Blend, OtherSurfacesDoNotCount) {
    const CachePoint point = pixel(8, 8);
    const BlockMap own = block(8, 8, 16);
    BlockMap turned = block(9, 9, 16, normalize({0.8f, 0, 0.6f})), raised = block(9, 9, 16),
             deeper = block(9, 9, 16), away = block(30, 8, 16);
    raised.anchor.position.z = 0.6f * 16 * footprint;
    deeper.anchor.depth = 1;
    for (const BlockMap* other : {&turned, &raised, &deeper, &away}) {
        const std::array<const BlockMap*, 2> both{other, &own};
        const Blend blend = blend_maps(point, both);
        ASSERT_EQ(blend.maps().size(), 1u);
        EXPECT_EQ(blend.maps()[0].map, &own);
        EXPECT_EQ(blend.maps()[0].weight, 1);
        EXPECT_TRUE(blend_maps(point, std::array<const BlockMap*, 1>{other}).empty());
    }
}

TEST(Blend, LosesWeightWithTheAngleWithoutAStep) {
    const CachePoint point = pixel(8, 8);
    const BlockMap own = block(8.5f, 8.5f, 16);
    float before = 0.5f;
    for (float angle = 0; angle < 0.8f; angle += 0.01f) {
        BlockMap other = block(8.5f, 8.5f, 16, {std::sin(angle), 0, std::cos(angle)});
        const std::array<const BlockMap*, 2> both{&own, &other};
        auto now = weights(blend_maps(point, both));
        ASSERT_LE(now[&other], before + 1e-5f);
        ASSERT_GT(now[&other], before - 0.05f);
        before = now[&other];
    }
    EXPECT_EQ(before, 0);
}

TEST(Blend, KeepsTheHeaviest) {
    std::vector<BlockMap> maps;
    for (int i = 0; i < 12; ++i) maps.push_back(block(8.5f + static_cast<float>(i * 5 % 12), 8.5f, 16));
    const Blend blend = blend_maps(pixel(8, 8), pointers(maps));
    ASSERT_EQ(blend.maps().size(), Blend::most);
    EXPECT_NEAR(sum(blend), 1, 1e-5f);
    for (const WeightedMap& m : blend.maps()) EXPECT_LT(m.map->center_x, 8.5f + Blend::most);
}

TEST(Blend, KnowsItsSmallestBlock) {
    const BlockMap large = block(32, 32, 64), small = block(40, 40, 16), other = block(20, 20, 32);
    Blend blend;
    EXPECT_EQ(blend.smallest_block(), infinity);
    for (const BlockMap* map : {&large, &small, &other}) blend.add(*map, 1);
    EXPECT_EQ(blend.smallest_block(), 16);
}

}  // namespace
}  // namespace relumine
