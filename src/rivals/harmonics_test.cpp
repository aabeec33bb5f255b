// SPDX-License-Identifier: Apache-2.0
// Harmonics are orthonormal, and turned coefficients are those of the turned function.
#include "rivals/harmonics.hpp"

#include <gtest/gtest.h>

#include <functional>

namespace relumine {
namespace {

constexpr int bands = 10;

/// Directions spread evenly over the sphere, each standing for `weight` steradian.
void over_sphere(const std::function<void(Vec3, float weight)>& visit) {
    constexpr int rows = 100, columns = 200;
    for (int i = 0; i < rows; ++i)
        for (int j = 0; j < columns; ++j) {
            const float theta = pi * (static_cast<float>(i) + 0.5f) / rows,
                        phi = 2 * pi * (static_cast<float>(j) + 0.5f) / columns;
            visit({std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)},
                  std::sin(theta) * (pi / rows) * (2 * pi / columns));
        }
}

std::vector<float> project(const std::function<float(Vec3)>& f) {
    std::vector<double> sums(harmonic_count(bands));
    HarmonicValues y;
    over_sphere([&](Vec3 d, float weight) {
        evaluate_harmonics(bands, d, y);
        const float value = f(d) * weight;
        for (std::size_t i = 0; i < sums.size(); ++i) sums[i] += static_cast<double>(value * y[i]);
    });
    return {sums.begin(), sums.end()};
}

TEST(Harmonics, AreOrthonormal) {
    std::vector<double> products(harmonic_count(bands) * harmonic_count(bands));
    HarmonicValues y;
    over_sphere([&](Vec3 d, float weight) {
        evaluate_harmonics(bands, d, y);
        for (std::size_t i = 0; i < harmonic_count(bands); ++i)
            for (std::size_t j = 0; j <= i; ++j)
                products[i * harmonic_count(bands) + j] += static_cast<double>(weight * y[i] * y[j]);
    });
    for (std::size_t i = 0; i < harmonic_count(bands); ++i)
        for (std::size_t j = 0; j <= i; ++j)
            ASSERT_NEAR(products[i * harmonic_count(bands) + j], i == j ? 1 : 0, 2e-3) << i << ' ' << j;
}

TEST(Harmonics, OfDegreeOneAreTheAxes) {
    HarmonicValues y;
    const Vec3 d = normalize({0.3f, -0.5f, 0.7f});
    evaluate_harmonics(bands, d, y);
    const float norm = std::sqrt(3 / (4 * pi));
    EXPECT_NEAR(y[1], norm * d.y, 1e-6f);
    EXPECT_NEAR(y[2], norm * d.z, 1e-6f);
    EXPECT_NEAR(y[3], norm * d.x, 1e-6f);
    EXPECT_NEAR(y[0], std::sqrt(1 / (4 * pi)), 1e-6f);
}

/// Uneven in every way.
float bumps(Vec3 d) { return std::exp(2 * d.x - d.y) + 3 * d.z * d.z * d.y + std::max(0.0f, d.z - 0.3f); }

/// A frame far from all axes.
Frame tilted() {
    Frame f = frame_around(normalize({0.4f, -0.7f, -0.2f}));
    const Vec3 s = f.s * 0.6f + f.t * 0.8f;
    return {s, cross(f.n, s), f.n};
}

TEST(HarmonicRotation, GivesTheCoefficientsOfTheTurnedFunction) {
    const Frame frame = tilted();
    const std::vector<float> own = project(bumps);
    const std::vector<float> expected = project([&](Vec3 d) { return bumps(frame.to_local({d}).v); });
    std::vector<float> turned(own.size());
    HarmonicRotation(bands, frame).turn(own, turned);
    for (std::size_t i = 0; i < own.size(); ++i) ASSERT_NEAR(turned[i], expected[i], 3e-3f) << i;
    HarmonicRotation(bands, {frame.t, frame.s, frame.n}).turn(own, turned);  // a mirror is no such rotation
    float worst = 0;
    for (std::size_t i = 0; i < own.size(); ++i) worst = std::max(worst, std::abs(turned[i] - expected[i]));
    EXPECT_GT(worst, 0.1f);
}

TEST(HarmonicRotation, KeepsTheEnergyOfEveryBand) {
    const std::vector<float> own = project(bumps);
    std::vector<float> turned(own.size());
    HarmonicRotation(bands, tilted()).turn(own, turned);
    for (int l = 0; l < bands; ++l) {
        float before = 0, after = 0;
        for (int m = -l; m <= l; ++m) {
            before += sqr(own[harmonic_index(l, m)]);
            after += sqr(turned[harmonic_index(l, m)]);
        }
        ASSERT_NEAR(after, before, 1e-4f * before + 1e-9f) << l;
    }
}

TEST(HarmonicRotation, ByNothingChangesNothing) {
    const std::vector<float> own = project(bumps);
    std::vector<float> turned(own.size());
    HarmonicRotation(bands, {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}).turn(own, turned);
    for (std::size_t i = 0; i < own.size(); ++i) EXPECT_NEAR(turned[i], own[i], 1e-5f);
}

}  // namespace
}  // namespace relumine
