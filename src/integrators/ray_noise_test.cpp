// SPDX-License-Identifier: Apache-2.0
// The predicted variance of sums over Sobol points against the one that many sums have.
#include "integrators/ray_noise.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "base/sample_stream.hpp"

namespace relumine {
namespace {

constexpr std::uint32_t trials = 2000;

struct Variances {
    double predicted = 0, true_one = 0;
};

/// Of the mean of `integrand` over `count` points, pooled over the trials. The variance of 2000 sums has a
/// standard error of about 3 %.
template <typename Integrand>
Variances variances(std::uint32_t count, const Integrand& integrand) {
    NoiseEstimate pooled;
    double sum = 0, squares = 0;
    for (std::uint32_t trial = 0; trial < trials; ++trial) {
        RayNoise noise;
        noise.rays = static_cast<float>(count);
        for (std::uint32_t i = 0; i < count; ++i) {
            const SampleStream stream{hash(trial, 7), i, count, PointSet::sobol};
            const float found =
                integrand(stream.next2(Dim::direction, 0), stream) / static_cast<float>(count);
            noise.count(2 * i >= count, found);
        }
        const NoiseEstimate one = noise_of(noise);
        pooled.independent += one.independent / trials;
        pooled.halves += one.halves / trials;
        pooled.rays = one.rays;
        const double mean = double{noise.halves[0]} + noise.halves[1];
        sum += mean;
        squares += mean * mean;
    }
    return {variance_of_sum(pooled), (squares - sum * sum / trials) / (trials - 1)};
}

float white(Point2, const SampleStream& stream) {
    return unit_float(static_cast<std::uint32_t>(hash(stream.key, stream.index)));
}
float edge(Point2 u, const SampleStream&) { return u.x + 0.7f * u.y > 0.8f ? 1.0f : 0.0f; }
float smooth(Point2 u, const SampleStream&) { return u.x * u.y + 1; }

TEST(RayNoise, OfWhiteNoiseIsThatOfIndependentRays) {
    for (const std::uint32_t count : {8u, 32u}) {
        const Variances v = variances(count, white);
        EXPECT_NEAR(v.predicted / v.true_one, 1, 0.2) << count;
        EXPECT_NEAR(v.true_one, 1.0 / 12 / count, 0.1 / 12 / count) << count;
    }
}

TEST(RayNoise, SeesWhatGoodPointsGain) {
    for (const std::uint32_t count : {16u, 64u}) {
        const double independent = 0.24 / count;  // about that of `edge`
        const Variances at_edges = variances(count, edge), of_smooth = variances(count, smooth);
        EXPECT_LT(at_edges.true_one, 0.5 * independent) << count;  // else this would prove nothing
        EXPECT_LT(at_edges.predicted, 2 * at_edges.true_one) << count;
        EXPECT_GT(at_edges.predicted, 0.5 * at_edges.true_one) << count;
        EXPECT_LT(of_smooth.predicted, 4 * of_smooth.true_one)
            << count;  // steeper than n^-3 is not told apart
        EXPECT_GT(of_smooth.predicted, 0.5 * of_smooth.true_one) << count;
    }
}

TEST(RayNoise, OfFewRaysIsWhatTheySay) {
    RayNoise one;
    one.rays = 1;
    one.count(false, 3);
    EXPECT_EQ(noise_of(one).independent, 9);  // it may as well have found nothing
    EXPECT_EQ(variance_of_sum({}), 0);
    EXPECT_EQ(variance_of_sum({2, 0.1f, 4}), 2);
    EXPECT_EQ(variance_of_sum({2, 5, 64}), 2);
}

TEST(RayNoise, FewSourcesDoNotTellHowWellPointsAreSpread) {
    EXPECT_GT(cautious_variance({1, 0, 64}, 1), 1);             // a single find, its halves alike by chance
    EXPECT_LT(cautious_variance({1, 0.01f, 64}, 1e4f), 0.05f);  // many that agree
    EXPECT_FLOAT_EQ(cautious_variance({1, 2, 64}, 4), 1.5f);
    EXPECT_LT(cautious_variance({1, 0.01f, 64}, 60), cautious_variance({1, 0.01f, 64}, 10));
    EXPECT_GT(cautious_variance({1, 0.01f, 64}, 60), variance_of_sum({1, 0.01f, 64}));
    EXPECT_EQ(cautious_variance({}, 1), 0);
}

TEST(RayNoise, ScalesWithTheSquare) {
    RayNoise a, b;
    a.rays = 4;
    for (const float found : {1.0f, 2.0f, 0.0f, 5.0f}) a.count(found > 1.5f, found);
    b.add(a, 3);
    EXPECT_FLOAT_EQ(noise_of(b).independent, 9 * noise_of(a).independent);
    EXPECT_FLOAT_EQ(noise_of(b).halves, 9 * noise_of(a).halves);
}

}  // namespace
}  // namespace relumine
