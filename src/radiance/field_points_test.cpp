// SPDX-License-Identifier: Apache-2.0
// Reservoirs: every point that is offered stays with the same probability.
#include "radiance/field_points.hpp"

#include <gtest/gtest.h>

#include "relumine/scene.hpp"

namespace relumine {
namespace {

StartPoint numbered(int i) { return {{static_cast<float>(i), 0, 0}, {0, 0, 1}, 0}; }

TEST(PointReservoirs, AFewPointsAllStayInOrder) {
    PointReservoirs met;
    for (int i = 0; i < 5; ++i) met.offer(7, numbered(i));
    ASSERT_EQ(met.of(7).size(), 5u);
    for (int i = 0; i < 5; ++i)
        EXPECT_EQ(met.of(7)[static_cast<std::size_t>(i)].position.x, static_cast<float>(i));
    EXPECT_TRUE(met.of(3).empty());
    EXPECT_TRUE(met.of(8).empty());
}

TEST(PointReservoirs, EarlyPointsAreKeptNoMoreOftenThanLateOnes) {
    constexpr int elements = 2000, offered = 64;
    PointReservoirs met;
    for (ElementId id = 0; id < elements; ++id)
        for (int i = 0; i < offered; ++i) met.offer(id, numbered(i));
    std::vector<int> kept(offered);
    for (ElementId id = 0; id < elements; ++id) {
        ASSERT_EQ(met.of(id).size(), PointReservoirs::most);
        for (const StartPoint& p : met.of(id)) ++kept[static_cast<std::size_t>(p.position.x)];
    }
    // Each count is binomial: mean 500, standard deviation 19; 64 of them within 5 of it, but for one in
    // 30,000.
    for (const int count : kept) EXPECT_NEAR(count, 500, 97);
}

Scene floor() {
    constexpr std::array<std::array<float, 3>, 4> corners{{{-9, 0, 9}, {9, 0, 9}, {9, 0, -9}, {-9, 0, -9}}};
    constexpr std::array<std::array<std::uint32_t, 3>, 2> triangles{{{0, 1, 2}, {0, 2, 3}}};
    SceneBuilder builder;
    MeshDescription quad;
    quad.positions = corners;
    quad.triangles = triangles;
    quad.material = builder.add_material({});
    builder.add_instance(builder.add_mesh(quad));
    return builder.build();
}

/// What the other side of a wall receives is nothing to the side that was met.
TEST(StartPoints, OfCoarseElementsAreWhereRaysHaveMetThem) {
    const Scene scene = floor();
    const Tracer tracer{scene.data(), {}};
    const LightSampler lights{scene.data(), {}};
    const UniformBsdfs bsdfs{scene.data(), Masking::correlated};
    const Transport transport{scene.data(), tracer, lights, bsdfs};
    CellScale scale;
    scale.core.add({0, 0, 0});
    scale.core.add({1, 1, 1});
    FieldCells cells(scale);
    const Vec3 up{0, 1, 0}, place{0.21f, 0, 0.19f};
    const ElementId coarse = cells.find_or_make_coarse(place, up, 0);
    const ElementId fine = cells.find_or_make_fine({0.61f, 0, 0.61f}, up, 0);
    const StartPoint met{place, up, 0};
    RayCounts rays;
    const auto points = [&](ElementId id, std::span<const StartPoint> of) {
        return start_points(transport, cells, id, of, 1, rays);
    };
    ASSERT_EQ(points(coarse, {&met, 1}).size(), 1u);
    EXPECT_EQ(points(coarse, {&met, 1})[0].position.x, place.x);
    EXPECT_GE(points(coarse, {}).size(), 4u);
    EXPECT_GE(points(fine, {&met, 1}).size(), 4u);
}

}  // namespace
}  // namespace relumine
