// SPDX-License-Identifier: Apache-2.0
// The octahedral square: a bijection of equal area, oriented as documented.
#include "blocks/octahedral_map.hpp"

#include <gtest/gtest.h>

#include "base/hash.hpp"
#include "tests/statistics.hpp"

namespace relumine {
namespace {

float uniform(std::uint64_t i, std::uint64_t what) {
    return unit_float(static_cast<std::uint32_t>(hash(i, what)));
}
Point2 random_point(std::uint64_t i) { return {uniform(i, 1), uniform(i, 2)}; }

WorldDir random_direction(std::uint64_t i) {
    const float z = 2 * uniform(i, 3) - 1, phi = 2 * pi * uniform(i, 4), r = std::sqrt(1 - z * z);
    return {{r * std::cos(phi), r * std::sin(phi), z}};
}

float angle(Vec3 a, Vec3 b) { return length(a - b); }  // of small ones

TEST(OctahedralMap, IsTheInverseOfItsInverse) {
    for (std::uint64_t i = 0; i < 200'000; ++i) {
        const WorldDir d = random_direction(i);
        const float there_and_back = angle(square_to_sphere(sphere_to_square(d)).v, d.v);
        // At the poles floats next to z = ±1 are 3.5e-4 rad apart.
        ASSERT_LT(there_and_back, 1 - std::abs(d.v.z) > 1e-3f ? 1e-5f : 4e-4f) << d.v.x << " " << d.v.y;
    }
    for (std::uint64_t i = 0; i < 200'000; ++i) {
        const Point2 p = random_point(i), q = sphere_to_square(square_to_sphere(p));
        const float height = 1 - std::abs(2 * p.x - 1) - std::abs(2 * p.y - 1);
        const float tolerance = 1 - std::abs(height) > 0.03f ? 5e-6f : 2.5e-4f;
        ASSERT_NEAR(q.x, p.x, tolerance) << p.x << " " << p.y;
        ASSERT_NEAR(q.y, p.y, tolerance) << p.x << " " << p.y;
    }
}

TEST(OctahedralMap, HasItsAxesWhereItSays) {
    const auto at = [](Point2 p, Vec3 d) {
        EXPECT_LT(angle(square_to_sphere(p).v, d), 1e-6f) << p.x << " " << p.y;
    };
    at({0.5f, 0.5f}, {0, 0, 1});
    for (const Point2 corner : {Point2{0, 0}, {1, 0}, {0, 1}, {1, 1}}) at(corner, {0, 0, -1});
    at({1, 0.5f}, {1, 0, 0});
    at({0, 0.5f}, {-1, 0, 0});
    at({0.5f, 1}, {0, 1, 0});
    at({0.5f, 0}, {0, -1, 0});
    for (std::uint64_t i = 0; i < 10'000; ++i) {
        const Point2 p = random_point(i);
        const Vec3 d = square_to_sphere(p).v;
        EXPECT_EQ(d.x >= 0, p.x >= 0.5f);
        EXPECT_EQ(d.y >= 0, p.y >= 0.5f);
        EXPECT_EQ(d.z >= 0, std::abs(2 * p.x - 1) + std::abs(2 * p.y - 1) <= 1);
    }
}

TEST(OctahedralMap, IsUnitLength) {
    for (std::uint64_t i = 0; i < 50'000; ++i)
        ASSERT_NEAR(length(square_to_sphere(random_point(i)).v), 1, 1e-6f);
    for (float k = 0; k <= 1; k += 1.0f / 64)  // on the folds, too
        for (const Point2 p : {Point2{k, 0}, {0, k}, {k, 1}, {k, k}})
            ASSERT_NEAR(length(square_to_sphere(p).v), 1, 1e-6f);
}

/// The octahedron projected onto the sphere: not uniform.
WorldDir projected_octahedron(Point2 p) {
    const float u = 2 * p.x - 1, v = 2 * p.y - 1, height = 1 - std::abs(u) - std::abs(v);
    return {normalize(
        height >= 0 ? Vec3{u, v, height}
                    : Vec3{std::copysign(1 - std::abs(v), u), std::copysign(1 - std::abs(u), v), height})};
}

/// χ² of random points of the square over cells of equal solid angle.
template <typename Map>
double uniformity_p(const Map& map) {
    constexpr int rows = 32, columns = 64, draws = 1'000'000;
    std::vector<double> observed(rows * columns),
        expected(rows * columns, static_cast<double>(draws) / (rows * columns));
    for (std::uint64_t i = 0; i < draws; ++i) {
        const Vec3 d = map(random_point(i)).v;
        const int row = std::clamp(static_cast<int>((d.z + 1) / 2 * rows), 0, rows - 1);
        const int column =
            std::clamp(static_cast<int>((std::atan2(d.y, d.x) / (2 * pi) + 0.5f) * columns), 0, columns - 1);
        ++observed[static_cast<std::size_t>(row * columns + column)];
    }
    return testing::chi_square_p(observed, expected);
}

TEST(OctahedralMap, IsUniformInSolidAngle) {  // χ², 32 × 64 cells, 10⁶ points, α = 1e-6
    EXPECT_GT(uniformity_p(square_to_sphere), 1e-6);
    EXPECT_LT(uniformity_p(projected_octahedron), 1e-6);  // the mutant must be caught
}

}  // namespace
}  // namespace relumine
