// SPDX-License-Identifier: Apache-2.0
// The map between square and hemisphere: its inverse, its measure, its border.
#include "cache/hemisphere_map.hpp"

#include <gtest/gtest.h>

#include "base/hash.hpp"
#include "tests/statistics.hpp"

namespace relumine {
namespace {

Point2 random_point(std::uint64_t i) {
    const std::uint64_t bits = hash(1, i);
    return {unit_float(static_cast<std::uint32_t>(bits)), unit_float(static_cast<std::uint32_t>(bits >> 32))};
}

bool inside(Point2 p) { return p.x >= 0 && p.x <= 1 && p.y >= 0 && p.y <= 1; }

TEST(HemisphereMap, ThereAndBackIsTheSamePoint) {
    for (std::uint64_t i = 0; i < 200'000; ++i) {
        const Point2 p = random_point(i);
        const LocalDir w = square_to_hemisphere(p);
        ASSERT_NEAR(length(w.v), 1, 1e-6f);
        ASSERT_GE(w.v.z, 0);
        const Point2 back = hemisphere_to_square(w);
        // z = 1 − r² is rounded to 6e-8: near the zenith r is known to 6e-8 / 2r alone
        const float r = std::max(std::abs(2 * p.x - 1), std::abs(2 * p.y - 1));
        const float tolerance = 1e-6f + std::min(5e-8f / r, 2e-4f);
        ASSERT_NEAR(back.x, p.x, tolerance) << p.x << " " << p.y;
        ASSERT_NEAR(back.y, p.y, tolerance) << p.x << " " << p.y;
    }
}

/// χ² over 40 × 40 cells of height and azimuth, which have the same solid angle; 10⁶ directions.
template <typename Map>
double p_of_uniform(const Map& map) {
    constexpr int side = 40, draws = 1'000'000;
    std::vector<double> observed(side * side), expected(side * side, double{draws} / (side * side));
    for (std::uint64_t i = 0; i < draws; ++i) {
        const LocalDir w = map(random_point(i));
        const double azimuth = std::atan2(double{w.v.y}, double{w.v.x}) / (2 * double{pi}) + 0.5;
        const int a = std::clamp(static_cast<int>(azimuth * side), 0, side - 1);
        const int z = std::clamp(static_cast<int>(w.v.z * side), 0, side - 1);
        ++observed[static_cast<std::size_t>(z * side + a)];
    }
    return testing::chi_square_p(observed, expected);
}

TEST(HemisphereMap, IsUniformInSolidAngle) {  // α = 1e-6
    EXPECT_GT(p_of_uniform(square_to_hemisphere), 1e-6);
    EXPECT_LT(p_of_uniform(cosine_hemisphere), 1e-6);  // the mutants must be caught
    EXPECT_LT(p_of_uniform([](Point2 p) { return square_to_hemisphere({0.99f * p.x, p.y}); }), 1e-6);
}

TEST(HemisphereMap, TheCentreIsTheZenith) {
    const LocalDir up = square_to_hemisphere({0.5f, 0.5f});
    EXPECT_EQ(up.v, (Vec3{0, 0, 1}));
    const Point2 center = hemisphere_to_square({{0, 0, 1}});
    EXPECT_EQ(center.x, 0.5f);
    EXPECT_EQ(center.y, 0.5f);
    const Point2 rounded_up =
        hemisphere_to_square({{1e-8f, -1e-8f, 1.0000001f}});  // z may be rounded beyond 1
    EXPECT_EQ(rounded_up.x, 0.5f);
    EXPECT_EQ(rounded_up.y, 0.5f);
}

TEST(HemisphereMap, TheBorderIsTheHorizon) {
    for (int i = 0; i <= 1000; ++i) {
        const float t = static_cast<float>(i) / 1000;
        for (const Point2 p : {Point2{t, 0}, {t, 1}, {0, t}, {1, t}}) {
            const LocalDir w = square_to_hemisphere(p);
            EXPECT_NEAR(w.v.z, 0, 1e-6f) << p.x << " " << p.y;
            EXPECT_NEAR(length(w.v), 1, 1e-6f);
        }
    }
    for (int i = 0; i < 1000; ++i) {
        const float azimuth = 2 * pi * static_cast<float>(i) / 1000;
        const Point2 p = hemisphere_to_square({{std::cos(azimuth), std::sin(azimuth), 0}});
        EXPECT_NEAR(std::max(std::abs(2 * p.x - 1), std::abs(2 * p.y - 1)), 1, 1e-6f);
    }
}

TEST(HemisphereMap, DirectionsBelowTheHorizonLandOutsideTheSquare) {
    for (std::uint64_t i = 0; i < 100'000; ++i) {
        LocalDir w = square_to_hemisphere(random_point(i));
        if (w.v.z < 1e-6f) continue;
        w.v.z = -w.v.z;
        const Point2 p = hemisphere_to_square(w);
        ASSERT_FALSE(inside(p)) << w.v.x << " " << w.v.y << " " << w.v.z;
        ASSERT_LE(std::max(std::abs(p.x - 0.5f), std::abs(p.y - 0.5f)), 0.5f + 0.21f);
    }
}

TEST(HemisphereMap, AxesKeepTheirSides) {
    EXPECT_EQ(hemisphere_to_square({{1, 0, 0}}).x, 1);
    EXPECT_EQ(hemisphere_to_square({{-1, 0, 0}}).x, 0);
    EXPECT_EQ(hemisphere_to_square({{0, 1, 0}}).y, 1);
    EXPECT_EQ(hemisphere_to_square({{0, -1, 0}}).y, 0);
}

TEST(HemisphereMap, TheOctantsPolynomialIsAnArcTangent) {
    for (int i = -10'000; i <= 10'000; ++i) {
        const double x = i / 10'000.0;
        const double expected = 4 / double{pi} * std::atan(x);
        const auto y = static_cast<float>(x);
        ASSERT_NEAR(octant(y), expected, 5e-7) << x;  // 4e-7 and roundings
        ASSERT_NEAR(octant(y, short_octant_polynomial), expected, 1.1e-4) << x;
    }
}

}  // namespace
}  // namespace relumine
