// SPDX-License-Identifier: Apache-2.0
// Tracing maps: what is known, what is open, and what is seen where.
#include "blocks/block_trace.hpp"

#include <gtest/gtest.h>

#include <bit>

#include "blocks/map_fill.hpp"
#include "blocks/test_maps.hpp"

namespace relumine {
namespace {

using testing::gather_point;
using testing::MapStage;
using testing::Quad;

struct Traced {
    BlockMap map;
    std::vector<float> distances;
    RayCounts counts;

    [[nodiscard]] bool knows(std::size_t texel) const {
        return (map.known[texel / tile_texels] >> texel % tile_texels & 1) != 0;
    }
    [[nodiscard]] bool is_open(std::size_t texel) const {
        return (map.open[texel / tile_texels] >> texel % tile_texels & 1) != 0;
    }
    [[nodiscard]] std::uint64_t rays() const {
        return counts.by_purpose[static_cast<std::size_t>(RayPurpose::record)];
    }
};

Traced trace(const MapStage& stage, const std::vector<GatherPoint>& starts, std::uint8_t rays_per_tile = 16) {
    const FlushDenormals flush;
    Traced traced;
    MapRecord record;
    trace_record(stage.source(), starts, TileRays(stage.grid().tiles, rays_per_tile), 7, record,
                 traced.counts);
    MapFill fill(stage.grid(), stage.environment());
    fill.run(record, {}, false, traced.map);
    fill.distances(record, traced.distances);
    return traced;
}

/// How far from a texel's centre its corners can be, radians.
float texel_radius(const DirectionGrid& grid) { return 1.5f * std::sqrt(grid.texel_solid_angle); }

TEST(BlockTrace, AnEmptySkyIsKnownAndOpenOverTheHorizonAlone) {
    const Spectrum sky{0.5f, 1, 2};
    const MapStage stage({}, testing::even_sky(sky), 32);
    const Vec3 normal = normalize({0.3f, -0.2f, 0.6f});
    const Traced traced = trace(stage, {gather_point({1, 2, 3}, normal)});
    for (std::size_t texel = 0; texel < stage.grid().texels; ++texel) {
        const float height = dot(stage.grid().texel_center(texel).v, normal);
        if (height > texel_radius(stage.grid())) {
            ASSERT_TRUE(traced.knows(texel) && traced.is_open(texel)) << texel;
            ASSERT_NEAR(traced.map.direct.at(texel).r, sky.r, 1e-5f);
            ASSERT_NEAR(traced.map.direct.at(texel).b, sky.b, 1e-5f);
            ASSERT_EQ(traced.distances[texel], infinity);
        } else if (height < -texel_radius(stage.grid())) {
            ASSERT_FALSE(traced.knows(texel) || traced.is_open(texel)) << texel;
            ASSERT_TRUE(is_black(traced.map.direct.at(texel)));
        }
        ASSERT_TRUE(traced.knows(texel) || !traced.is_open(texel));
    }
    EXPECT_TRUE(traced.map.indirect.empty());  // the source reflects nothing
}

TEST(BlockTrace, AWallIsSeenWhereItStands) {
    const Spectrum sky{1}, wall{3, 2, 1};
    const MapStage stage({Quad{{-50, -50, 2}, {50, 0, 0}, {0, 100, 0}, wall}}, testing::even_sky(sky), 32);
    const Traced traced = trace(stage, {gather_point({}, {0, 0, 1})});
    int on_wall = 0, beside = 0;
    for (std::size_t texel = 0; texel < stage.grid().texels; ++texel) {
        const Vec3 d = stage.grid().texel_center(texel).v;
        const float margin = texel_radius(stage.grid());
        if (d.z < margin || std::abs(d.x) < margin || -d.x * 2 / d.z > 25 || std::abs(d.y) * 2 / d.z > 25)
            continue;
        ASSERT_TRUE(traced.knows(texel));
        ASSERT_EQ(traced.is_open(texel), d.x > 0) << texel;
        ASSERT_NEAR(traced.map.direct.at(texel).r, d.x > 0 ? sky.r : wall.r, 1e-5f);
        ASSERT_NEAR(traced.map.direct.at(texel).b, d.x > 0 ? sky.b : wall.b, 1e-5f);
        if (d.x < 0) {
            ASSERT_LE(traced.distances[texel], 2 / std::max(d.z - margin, 0.01f));
            ASSERT_GE(traced.distances[texel], 2 / std::min(d.z + margin, 1.0f) * 0.9999f);
        }
        ++(d.x < 0 ? on_wall : beside);
    }
    EXPECT_GT(on_wall, 100);
    EXPECT_GT(beside, 100);
}

TEST(BlockTrace, WhatTheAnchorCannotSeeAnotherStartDoes) {
    const MapStage stage({}, testing::even_sky(Spectrum{1}), 32);
    const Vec3 tilted = normalize({0.6f, 0, 0.8f});
    const GatherPoint anchor = gather_point({}, {0, 0, 1}), other = gather_point({1, 0, 0}, tilted);
    const Traced alone = trace(stage, {anchor}), both = trace(stage, {anchor, other});
    int gained = 0;
    for (std::size_t texel = 0; texel < stage.grid().texels; ++texel) {
        const Vec3 d = stage.grid().texel_center(texel).v;
        const float margin = texel_radius(stage.grid());
        if (d.z < -margin && dot(d, tilted) > margin) {
            ASSERT_FALSE(alone.knows(texel));
            ASSERT_TRUE(both.knows(texel) && both.is_open(texel));
            ++gained;
        }
        if (d.z < -margin && dot(d, tilted) < -margin) {
            ASSERT_FALSE(both.knows(texel));
        }
    }
    EXPECT_GT(gained, 20);
}

/// Rays start at the anchor wherever it sees: of two panels only that over the anchor shows.
TEST(BlockTrace, TheAnchorComesFirst) {
    const Spectrum near_anchor{5, 0, 0}, near_other{0, 5, 0};
    const MapStage stage({Quad{{-1, -1, 0.5f}, {0, 2, 0}, {2, 0, 0}, near_anchor},
                          Quad{{99, -1, 0.5f}, {0, 2, 0}, {2, 0, 0}, near_other}},
                         testing::even_sky(Spectrum{1}), 16);
    const Traced traced = trace(stage, {gather_point({}, {0, 0, 1}), gather_point({100, 0, 0}, {0, 0, 1})});
    const std::size_t up = stage.grid().texel_at({{0.02f, 0.01f, 0.9998f}});
    EXPECT_NEAR(traced.map.direct.at(up).r, 5, 1e-5f);
    EXPECT_NEAR(traced.map.direct.at(up).g, 0, 1e-5f);
}

TEST(BlockTrace, ARayStandsForItsShareOfATile) {
    const MapStage stage({Quad{{-50, -50, 2}, {50, 0, 0}, {0, 100, 0}, Spectrum{3}},
                          Quad{{0, 0, 3}, {0, 80, 0}, {20, 0, 0}, Spectrum{2}}},
                         testing::even_sky(Spectrum{1}), 16);
    const GatherPoint start = gather_point({0.03f, 0.02f, 0}, {0, 0, 1});
    std::array<int, 3> mixed{};
    for (std::size_t density = 0; density < 3; ++density) {
        const auto rays = static_cast<std::uint8_t>(1u << 2 * density);  // per tile
        const Traced traced = trace(stage, {start}, rays);
        const std::size_t run = tile_texels / rays;
        for (std::size_t first = 0; first < stage.grid().texels; first += run)
            for (std::size_t texel = first + 1; texel < first + run; ++texel) {
                ASSERT_EQ(traced.knows(texel), traced.knows(first));
                ASSERT_EQ(traced.is_open(texel), traced.is_open(first));
                ASSERT_EQ(traced.distances[texel], traced.distances[first]);
                if (!traced.is_open(texel)) {
                    ASSERT_EQ(traced.map.direct.at(texel), traced.map.direct.at(first));
                }
            }
        for (const std::uint16_t open : traced.map.open) mixed[density] += open != 0 && open != whole_tile;
        EXPECT_LE(traced.rays(), stage.grid().tiles * rays);
        EXPECT_GT(traced.rays(), stage.grid().tiles * rays * 2 / 5);  // over the horizon
    }
    EXPECT_EQ(mixed[0], 0);
    EXPECT_GT(mixed[1], 0);
    EXPECT_GT(mixed[2], mixed[1]);
}

TEST(BlockTrace, TilesWithoutRaysStayUnknown) {
    const MapStage stage({}, testing::even_sky(Spectrum{1}), 16);
    const Traced traced = trace(stage, {gather_point({}, {0, 0, 1})}, 0);
    EXPECT_EQ(traced.rays(), 0u);
    for (const std::uint16_t known : traced.map.known) EXPECT_EQ(known, 0);
    for (const float mean : traced.map.tile_luminance) EXPECT_EQ(mean, 0);
}

TEST(BlockTrace, IsAFunctionOfItsArguments) {
    const MapStage stage({Quad{{-1, -1, 2}, {2, 0, 0}, {0, 2, 0}, Spectrum{3}}},
                         testing::even_sky(Spectrum{1}), 16);
    const GatherPoint start = gather_point({}, {0, 0, 1});
    const Traced a = trace(stage, {start}), b = trace(stage, {start});
    EXPECT_EQ(a.map.direct.texels, b.map.direct.texels);
    EXPECT_EQ(a.distances, b.distances);
}

TEST(BlockTrace, EmittersThatAreSampledAreNotInTheMap) {
    const MapStage stage({Quad{{-1, -1, 2}, {0, 2, 0}, {2, 0, 0}, Spectrum{500}}},
                         testing::even_sky(Spectrum{1}), 16);
    const Traced traced = trace(stage, {gather_point({}, {0, 0, 1})});
    const std::size_t up = stage.grid().texel_at({{0.02f, 0.01f, 0.9998f}});
    EXPECT_TRUE(traced.knows(up));
    EXPECT_FALSE(traced.is_open(up));
    EXPECT_TRUE(is_black(traced.map.direct.at(up)));
}

TEST(BlockMap, MeansAndVariancesAreOverTheKnownTexels) {
    const DirectionGrid grid(16);
    const BlockMap map = testing::random_map(grid, 5);
    for (std::size_t tile = 0; tile < grid.tiles; ++tile) {
        Vec3 moment;
        double sum = 0, squares = 0;
        const int known = std::popcount(map.known[tile]);
        for (std::size_t i = tile * tile_texels; i < (tile + 1) * tile_texels; ++i) {
            moment += grid.texel_center(i).v * map.direct.at(i).g;
            if (!(map.known[tile] >> i % tile_texels & 1)) continue;
            const double l = luminance(map.direct.at(i)) + luminance(map.indirect.at(i));
            sum += l;
            squares += l * l;
        }
        const double mean = known ? sum / known : 0, variance = known ? squares / known - mean * mean : 0;
        EXPECT_NEAR(map.tile_luminance[tile], mean, 1e-4);
        EXPECT_NEAR(map.tile_variance[tile], variance, 1e-3);
        const std::array<float, 3> axes{moment.x, moment.y, moment.z};
        for (std::size_t axis = 0; axis < 3; ++axis)
            EXPECT_NEAR(map.direct.tile_moments[1][axis][tile],
                        known ? axes[axis] / static_cast<float>(known) : 0, 1e-4);
    }
}

}  // namespace
}  // namespace relumine
