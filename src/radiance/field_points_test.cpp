// SPDX-License-Identifier: Apache-2.0
// Reservoirs: every point that is offered stays with the same probability.
#include "radiance/field_points.hpp"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace relumine
