// SPDX-License-Identifier: Apache-2.0
// Records reprojected into maps: where their points appear, what is hidden, and what it is worth.
#include "blocks/map_fill.hpp"

#include <gtest/gtest.h>

#include "blocks/test_maps.hpp"
#include "tests/targets.hpp"

namespace relumine {
namespace {

using testing::even_sky;
using testing::gather_point;
using testing::MapStage;
using testing::on_every_target;
using testing::Quad;
using testing::uniform;

MapRecord record_at(const MapStage& stage, Vec3 position, std::uint8_t rays_per_tile, std::uint64_t key,
                    Vec3 normal = {0, 0, 1}) {
    const FlushDenormals flush;
    MapRecord record;
    RayCounts rays;
    const GatherPoint start = gather_point(position, normal);
    trace_record(stage.source(), {&start, 1}, TileRays(stage.grid().tiles, rays_per_tile), key, record, rays);
    return record;
}

BlockMap filled(const MapStage& stage, const MapRecord& record, const std::vector<MapRecord>& others) {
    std::vector<const MapRecord*> pointers;
    for (const MapRecord& other : others) pointers.push_back(&other);
    BlockMap map;
    MapFill(stage.grid(), stage.environment()).run(record, pointers, false, map);
    return map;
}

TEST(RecordProjection, IsThatOfTheGridOnEveryTarget) {
    const DirectionGrid grid(64);
    MapRecord record;
    const Vec3 eye{1, -2, 3};
    for (std::uint64_t i = 0; i < 1003; ++i)
        record.add({}, eye + testing::random_direction(i, 5).v * uniform(i, 8, 0.01f, 50));
    record.pad();
    on_every_target([&] {
        ProjectedPoints projected;
        project_points(grid, record, eye, projected);
        for (std::size_t i = 0; i < record.seen.size(); ++i) {
            const Vec3 off = Vec3{record.x[i], record.y[i], record.z[i]} - eye;
            ASSERT_NEAR(projected.distances2[i], length_squared(off), 1e-6f * length_squared(off));
            ASSERT_LT(projected.texels[i], grid.texels);
            if (projected.texels[i] == grid.texel_at({normalize(off)})) continue;
            // Rounded to the other side of a border: then the point lies on it.
            const float cosine = dot(grid.texel_center(projected.texels[i]).v, normalize(off));
            const float corner = 0.8f * std::sqrt(grid.texel_solid_angle);
            ASSERT_GT(cosine, std::cos(corner)) << i;
        }
    });
}

TEST(MapFill, AnEvenWorldStaysEven) {
    const MapStage stage({Quad{{-50, -50, 2}, {100, 0, 0}, {0, 100, 0}, Spectrum{3, 2, 1}}},
                         even_sky(Spectrum{3, 2, 1}), 32);
    std::vector<MapRecord> others;
    for (std::uint64_t i = 0; i < 6; ++i)
        others.push_back(record_at(stage, {uniform(i, 1, -1, 1), uniform(i, 2, -1, 1), 0}, 4, i));
    const BlockMap map = filled(stage, record_at(stage, {}, 1, 9), others);
    for (std::size_t texel = 0; texel < stage.grid().texels; ++texel) {
        if (!(map.known[texel / tile_texels] >> texel % tile_texels & 1)) continue;
        ASSERT_NEAR(map.direct.at(texel).r, 3, 1e-5f);
        ASSERT_NEAR(map.direct.at(texel).b, 1, 1e-5f);
    }
}

/// Stripes on a ceiling: the more records around, the nearer a map of few rays of its own comes to one of
/// many.
TEST(MapFill, OtherRecordsTellWhatLiesBetweenTheRays) {
    std::vector<Quad> stripes;
    for (int i = 0; i < 20; ++i)
        stripes.push_back({{-20, -20 + 2 * static_cast<float>(i), 3},
                           {40, 0, 0},
                           {0, 2, 0},
                           Spectrum{i % 2 ? 4.0f : 0.0f}});
    const MapStage stage(stripes, even_sky(Spectrum{1}), 32);
    std::vector<BlockMap> dense;
    for (std::uint64_t key = 0; key < 16; ++key)
        dense.push_back(filled(stage, record_at(stage, {}, 16, 100 + key), {}));
    const auto error = [&](const BlockMap& map) {
        double sum = 0;
        for (std::size_t tile = 0; tile < stage.grid().tiles; ++tile) {
            double truth = 0;
            for (const BlockMap& d : dense) truth += d.tile_luminance[tile] / 16;
            sum += std::abs(map.tile_luminance[tile] - truth);
        }
        return sum;
    };
    const MapRecord own = record_at(stage, {}, 1, 1);
    std::vector<MapRecord> others;
    const double alone = error(filled(stage, own, others));
    for (std::uint64_t i = 0; i < 16; ++i)
        others.push_back(
            record_at(stage, {uniform(i, 1, -0.3f, 0.3f), uniform(i, 2, -0.3f, 0.3f), 0}, 1, i + 2));
    EXPECT_LT(error(filled(stage, own, others)), alone / 2.5);
}

/// A bar hides a bright wall from the anchor; a neighbour sees past it.
TEST(MapFill, WhatABarHidesStaysHidden) {
    const Quad wall{{-50, -50, 10}, {100, 0, 0}, {0, 100, 0}, Spectrum{9}};
    const Quad bar{{-0.5f, -50, 0.5f}, {1, 0, 0}, {0, 100, 0}, Spectrum{1}};
    const MapStage stage({wall, bar}, even_sky(Spectrum{1}), 32);
    const MapRecord own = record_at(stage, {}, 1, 1);
    const std::vector<MapRecord> others{record_at(stage, {1.5f, 0, 0}, 16, 2)};
    ProjectedPoints projected;
    project_points(stage.grid(), others[0], {}, projected);
    int would_show = 0;
    const BlockMap map = filled(stage, own, others);
    for (std::size_t i = 0; i < others[0].seen.size(); ++i) {
        const Vec3 d = stage.grid().texel_center(projected.texels[i]).v;
        if (others[0].seen[i].direct.r < 5 || std::abs(d.x) > 0.35f * d.z || d.z < 0.6f)
            continue;  // the bar ends at d.x = d.z, and a tile that it ends in is mixed
        ++would_show;
        EXPECT_NEAR(map.direct.at(projected.texels[i]).r, 1, 1e-5f) << d.x << " " << d.y << " " << d.z;
    }
    EXPECT_GT(would_show, 20);
}

/// The same for a sky behind the bar.
TEST(MapFill, ABarHidesTheSky) {
    const Quad bar{{-0.5f, -50, 0.5f}, {1, 0, 0}, {0, 100, 0}, Spectrum{1}};
    const MapStage stage({bar}, even_sky(Spectrum{9}), 32);
    const std::vector<MapRecord> others{record_at(stage, {1.5f, 0, 0}, 16, 2)};
    const BlockMap map = filled(stage, record_at(stage, {}, 1, 1), others);
    const std::size_t up = stage.grid().texel_at({normalize({0.02f, 0.03f, 1})});
    EXPECT_NEAR(map.direct.at(up).r, 1, 1e-5f);
    EXPECT_FALSE(map.open[up / tile_texels] >> up % tile_texels & 1);
}

/// Walls of a corner are near, but cannot hide each other: their points count however far the other anchor.
TEST(MapFill, InACornerEverythingIsSeen) {
    const MapStage stage({Quad{{-0.2f, -50, -50}, {0, 100, 0}, {0, 0, 100}, Spectrum{2}},
                          Quad{{-50, -0.2f, -50}, {100, 0, 0}, {0, 0, 100}, Spectrum{5}}},
                         even_sky(Spectrum{1}), 32);
    const MapRecord own = record_at(stage, {}, 1, 1), other = record_at(stage, {2, 2, 0}, 16, 2);
    const BlockMap map = filled(stage, own, {other});
    ProjectedPoints projected;
    project_points(stage.grid(), other, {}, projected);
    int seen = 0;
    for (std::size_t i = 0; i < other.seen.size(); ++i) {
        const std::uint32_t texel = projected.texels[i];
        const Spectrum held = map.direct.at(texel);
        // Wherever the other record's rays have met a wall, the map holds that wall, mixed with no more than
        // what else lies in the texel.
        seen += std::abs(held.r - other.seen[i].direct.r) < 1e-4f;
    }
    EXPECT_GT(seen, static_cast<int>(other.seen.size()) * 9 / 10);
}

TEST(NearestRecords, AreTheNearestOfTheSameDepth) {
    std::vector<MapRecord> records(6);
    for (std::size_t i = 0; i < records.size(); ++i)
        records[i].anchor = gather_point({static_cast<float>(i), 0, 0}, {0, 0, 1});
    records[3].anchor.depth = 2;
    std::vector<const MapRecord*> pointers;
    for (const MapRecord& record : records) pointers.push_back(&record);
    EXPECT_EQ(nearest_records(records[2], pointers, 3),
              (std::vector<const MapRecord*>{&records[1], &records[0], &records[4]}));
    EXPECT_EQ(nearest_records(records[3], pointers, 3), std::vector<const MapRecord*>{});
    EXPECT_EQ(nearest_records(records[0], pointers, 10).size(), 4u);
}

}  // namespace
}  // namespace relumine
