// SPDX-License-Identifier: Apache-2.0
// Random numbers: stratification, uniformity, independence.
#include "base/sample_stream.hpp"

#include <gtest/gtest.h>

#include <set>

#include "base/sobol.hpp"
#include "tests/statistics.hpp"

namespace relumine {
namespace {

std::vector<Point2> points(PointSet set, std::uint32_t count, std::uint64_t key, Dim dim = Dim::direction) {
    std::vector<Point2> all;
    for (std::uint32_t i = 0; i < count; ++i) all.push_back(SampleStream{key, i, count, set}.next2(dim));
    return all;
}

/// Whether every cell of the columns × rows grid holds exactly one of columns·rows points.
bool one_in_each_cell(const std::vector<Point2>& all, int columns, int rows) {
    std::set<std::pair<int, int>> cells;
    for (const Point2 p : all)
        cells.emplace(static_cast<int>(p.x * static_cast<float>(columns)),
                      static_cast<int>(p.y * static_cast<float>(rows)));
    return cells.size() == all.size();
}

TEST(Sobol, EveryElementaryIntervalOf256PointsHoldsOne) {
    for (std::uint64_t key = 0; key < 8; ++key) {
        const auto all = points(PointSet::sobol, 256, key);
        for (int columns = 1; columns <= 256; columns *= 2)
            EXPECT_TRUE(one_in_each_cell(all, columns, 256 / columns)) << columns;
    }
}

TEST(Sobol, LaterRunsAreStratifiedToo) {
    std::vector<Point2> all;
    for (std::uint32_t i = 64; i < 128; ++i)
        all.push_back(SampleStream{3, i, 1, PointSet::sobol}.next2(Dim::pixel));
    EXPECT_TRUE(one_in_each_cell(all, 8, 8));
}

TEST(Sobol, SecondDimensionMatchesItsGeneratorMatrix) {
    for (std::uint32_t index = 0; index < 4096; ++index) {
        std::uint32_t expected = 0, direction = 1u << 31;
        for (std::uint32_t i = index; i != 0; i >>= 1, direction ^= direction >> 1)
            if (i & 1) expected ^= direction;
        ASSERT_EQ(reverse_bits(sobol_second_reversed(index)), expected) << index;
    }
}

TEST(Stratified, FillsEveryStratum) {
    EXPECT_TRUE(one_in_each_cell(points(PointSet::stratified, 4096, 1), 64, 64));
    EXPECT_TRUE(one_in_each_cell(points(PointSet::stratified, 12, 1), 3, 4));
}

TEST(Stratified, StaysInTheUnitSquareForAnyCount) {
    for (const std::uint32_t count : {1u, 2u, 3u, 5u, 7u, 17u, 101u})
        for (const Point2 p : points(PointSet::stratified, count, count)) {
            EXPECT_GE(std::min(p.x, p.y), 0);
            EXPECT_LT(std::max(p.x, p.y), 1);
        }
}

/// χ² over a 16 × 16 grid of one point from each of many keys: what different pixels see must be uniform.
double uniformity_p(PointSet set, std::uint32_t index, std::uint32_t count) {
    constexpr int side = 16, draws = 100'000;
    std::vector<double> observed(side * side), expected(side * side, double{draws} / (side * side));
    for (std::uint64_t key = 0; key < draws; ++key) {
        const Point2 p = SampleStream{mix(key), index, count, set}.next2(Dim::light_point, 2);
        ++observed[static_cast<std::size_t>(static_cast<int>(p.y * side) * side
                                            + static_cast<int>(p.x * side))];
    }
    return testing::chi_square_p(observed, expected);
}

TEST(SampleStream, IsUniformOverPixels) {
    const double level = testing::sidak(1e-6, 12);
    for (const PointSet set : {PointSet::sobol, PointSet::stratified, PointSet::independent})
        for (const std::uint32_t index : {0u, 5u})
            for (const std::uint32_t count : {16u, 127u})  // the second leaves no whole grid
                EXPECT_GT(uniformity_p(set, index, count), level) << index << " of " << count;
}

/// Correlation of two dimensions' first coordinates over the samples of one pixel, averaged over pixels.
double mean_correlation(PointSet set, Dim a, Dim b) {
    constexpr std::uint32_t count = 64;
    double sum = 0;
    constexpr int pixels = 500;
    for (std::uint64_t key = 0; key < pixels; ++key)
        for (std::uint32_t i = 0; i < count; ++i) {
            const SampleStream s{mix(key), i, count, set};
            sum += (double{s.next2(a).x} - 0.5) * (double{s.next2(b).x} - 0.5) * 12;
        }
    return sum / (double{count} * pixels);
}

TEST(SampleStream, DimensionsDoNotCorrelate) {  // 5 σ of 32,000 independent products is .028
    for (const PointSet set : {PointSet::sobol, PointSet::stratified, PointSet::independent}) {
        EXPECT_LT(std::abs(mean_correlation(set, Dim::direction, Dim::light_point)), 0.028);
        EXPECT_GT(mean_correlation(set, Dim::direction, Dim::direction),
                  0.9);  // the same dimension must be caught
    }
}

}  // namespace
}  // namespace relumine
