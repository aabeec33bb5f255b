// SPDX-License-Identifier: Apache-2.0
// The distribution over the receiver's square: samples follow the density, and what has no weight is never
// drawn.
#include "cache/product_distribution.hpp"

#include <gtest/gtest.h>

#include "base/hash.hpp"
#include "cache/hemisphere_map.hpp"
#include "tests/statistics.hpp"

namespace relumine {
namespace {

constexpr float below_one = 0x1.fffffep-1f;

Point2 random_point(std::uint64_t i) {
    const std::uint64_t bits = hash(2, i);
    return {unit_float(static_cast<std::uint32_t>(bits)), unit_float(static_cast<std::uint32_t>(bits >> 32))};
}

/// Weights over three orders of magnitude, cell by cell at random.
std::vector<float> rough_weights() {
    std::vector<float> weights(cell_count);
    for (std::size_t i = 0; i < cell_count; ++i)
        weights[i] = std::pow(10.0f, 3 * unit_float(static_cast<std::uint32_t>(hash(3, i))) - 2);
    return weights;
}

ProductDistribution distribution_of(const std::vector<float>& weights) {
    ProductDistribution distribution;
    distribution.build(weights);
    return distribution;
}

std::size_t cell_of(LocalDir w) {
    const Point2 p = hemisphere_to_square(w);
    const auto along = [](float c) { return std::clamp(static_cast<int>(c * cell_side), 0, cell_side - 1); };
    return static_cast<std::size_t>(along(p.y) * cell_side + along(p.x));
}

LocalDir center_of(std::size_t cell) {
    const auto x = static_cast<float>(cell % cell_side), y = static_cast<float>(cell / cell_side);
    return square_to_hemisphere({(x + 0.5f) / cell_side, (y + 0.5f) / cell_side});
}

/// χ² over all 64 × 64 cells, 10⁶ draws of `squeeze`d numbers.
template <typename Squeeze>
double chi_square(const Squeeze& squeeze) {
    constexpr int draws = 1'000'000;
    const ProductDistribution distribution = distribution_of(rough_weights());
    std::vector<double> observed(cell_count), expected(cell_count);
    for (std::size_t i = 0; i < cell_count; ++i)
        expected[i] = draws * double{distribution.pdf(center_of(i))} * double{cell_solid_angle};
    for (std::uint64_t i = 0; i < draws; ++i)
        ++observed[cell_of(distribution.sample(squeeze(random_point(i))).w_in)];
    return testing::chi_square_p(observed, expected);
}

TEST(ProductDistribution, SamplesFollowThePdf) {  // α = 1e-6
    EXPECT_GT(chi_square([](Point2 u) { return u; }), 1e-6);
    EXPECT_LT(chi_square([](Point2 u) {
                  return Point2{0.99f * u.x, u.y};
              }),
              1e-6);  // the mutants must be caught
    EXPECT_LT(chi_square([](Point2 u) { return Point2{u.x, 0.99f * u.y}; }), 1e-6);
}

TEST(ProductDistribution, SamplesAreUniformWithinTheirCell) {  // χ², 16 × 16 places, 10⁶ draws, α = 1e-6
    const auto p_within = [](auto bend) {
        constexpr int side = 16, draws = 1'000'000;
        const ProductDistribution distribution = distribution_of(rough_weights());
        std::vector<double> observed(side * side), expected(side * side, double{draws} / (side * side));
        for (std::uint64_t i = 0; i < draws; ++i) {
            const Point2 p = hemisphere_to_square(distribution.sample(random_point(i)).w_in);
            const auto place = [&](float c) {
                const float cells = c * cell_side;
                return std::clamp(static_cast<int>(bend(cells - std::floor(cells)) * side), 0, side - 1);
            };
            ++observed[static_cast<std::size_t>(place(p.y) * side + place(p.x))];
        }
        return testing::chi_square_p(observed, expected);
    };
    EXPECT_GT(p_within([](float t) { return t; }), 1e-6);
    EXPECT_LT(p_within([](float t) { return t * (0.98f + 0.02f * t); }), 1e-6);  // density that drifts by 4 %
}

TEST(ProductDistribution, SampleAndPdfSayTheSame) {
    const ProductDistribution distribution = distribution_of(rough_weights());
    constexpr int draws = 100'000;
    int differ = 0;
    for (std::uint64_t i = 0; i < draws; ++i) {
        const DirectionSample s = distribution.sample(random_point(i));
        ASSERT_GT(s.pdf, 0);
        differ += distribution.pdf(s.w_in) == s.pdf ? 0 : 1;
    }
    EXPECT_LT(differ, draws / 10'000);  // on the border between two cells alone
}

TEST(ProductDistribution,
     PdfIntegratesToOne) {  // over the sphere by height and azimuth, which know of no cells
    const ProductDistribution distribution = distribution_of(rough_weights());
    constexpr int heights = 1200, azimuths = 2400;
    double sum = 0;
    for (int i = -heights; i < heights; ++i)
        for (int j = 0; j < azimuths; ++j) {
            const float z = (static_cast<float>(i) + 0.5f) / heights;
            const float azimuth = 2 * pi * (static_cast<float>(j) + 0.5f) / azimuths,
                        r = std::sqrt(1 - z * z);
            sum += double{distribution.pdf({{r * std::cos(azimuth), r * std::sin(azimuth), z}})};
        }
    EXPECT_NEAR(sum * 2 * double{pi} / (double{heights} * azimuths), 1, 2e-3);
}

TEST(ProductDistribution, BelowTheHorizonIsNothing) {
    const ProductDistribution distribution = distribution_of(std::vector<float>(cell_count, 1.0f));
    EXPECT_EQ(distribution.pdf({{0, 0, -1}}), 0);
    EXPECT_EQ(distribution.pdf({{0.8f, 0, -0.6f}}), 0);
    EXPECT_NEAR(distribution.pdf({{0.8f, 0, 0.6f}}), 1 / (2 * pi), 1e-6f);
}

TEST(ProductDistribution, WithoutWeightsItIsEmpty) {
    EXPECT_TRUE(distribution_of(std::vector<float>(cell_count, 0.0f)).empty());
    EXPECT_FALSE(distribution_of(rough_weights()).empty());
}

TEST(ProductDistribution, BuildingAnewForgetsWhatWas) {
    ProductDistribution distribution = distribution_of(rough_weights());
    std::vector<float> one(cell_count);
    one[77] = 3;
    distribution.build(one);
    EXPECT_EQ(cell_of(distribution.sample({0.3f, 0.9f}).w_in), 77u);
    distribution.build(std::vector<float>(cell_count, 0.0f));
    EXPECT_TRUE(distribution.empty());
}

TEST(ProductDistribution, ASingleCellTakesAllSamples) {
    for (const std::size_t cell :
         {std::size_t{0}, std::size_t{63}, std::size_t{1234}, cell_count - 64, cell_count - 1}) {
        std::vector<float> weights(cell_count);
        weights[cell] = 1e-30f;
        const ProductDistribution distribution = distribution_of(weights);
        ASSERT_FALSE(distribution.empty());
        for (const float x : {0.0f, 0.3f, 0.999f})
            for (const float y : {0.0f, 0.7f, 0.999f}) {
                const DirectionSample s = distribution.sample({x, y});
                EXPECT_NEAR(s.pdf * cell_solid_angle, 1, 1e-6f);
                const Point2 p = hemisphere_to_square(s.w_in);
                EXPECT_NEAR(p.x * cell_side, static_cast<float>(cell % cell_side) + x, 1e-3f);
                EXPECT_NEAR(p.y * cell_side, static_cast<float>(cell / cell_side) + y, 1e-3f);
            }
    }
}

TEST(ProductDistribution, NumbersAtTheEndsMeetOnlyCellsWithWeight) {
    std::vector<float> weights(cell_count);
    for (std::size_t i = 0; i < cell_count; ++i) {  // empty rows and columns at all four borders and within
        const std::size_t x = i % cell_side, y = i / cell_side;
        if (x > 2 && x < 60 && y > 4 && y < 58 && x % 7 != 0 && y % 5 != 0)
            weights[i] = 1 + static_cast<float>(hash(4, i) % 100);
    }
    for (const float scale : {1.0f, 1e-20f, 1e20f, 0.1f, 1 / 3.0f}) {
        std::vector<float> scaled = weights;
        for (float& w : scaled) w *= scale;
        const ProductDistribution distribution = distribution_of(scaled);
        for (const float x : {0.0f, 0x1p-24f, 0.5f, 1 - 0x1p-23f, below_one})
            for (const float y : {0.0f, 0x1p-24f, 0.5f, 1 - 0x1p-23f, below_one}) {
                const DirectionSample s = distribution.sample({x, y});
                EXPECT_GT(s.pdf, 0) << x << " " << y << " " << scale;
                EXPECT_TRUE(std::isfinite(s.pdf));
                EXPECT_NEAR(length(s.w_in.v), 1, 1e-6f);
                EXPECT_GT(s.w_in.v.z, 0);
            }
    }
}

}  // namespace
}  // namespace relumine
