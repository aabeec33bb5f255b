// SPDX-License-Identifier: Apache-2.0
// Environments: orientation, interpolation, sampling.
#include "shading/environment_light.hpp"

#include <gtest/gtest.h>

#include "base/sample_stream.hpp"
#include "tests/statistics.hpp"

namespace relumine {
namespace {

Environment random_environment(int width, int height, float rotation) {
    Environment e{width, height, {}, rotation};
    for (int i = 0; i < width * height; ++i) {
        const float x = unit_float(static_cast<std::uint32_t>(mix(static_cast<std::uint64_t>(i))));
        e.radiance.emplace_back(x * x * x * 20, x, 0.1f);
    }
    return e;
}

/// The environment in which one texel shines.
Environment one_texel(int x, int y, float rotation = 0) {
    Environment e{8, 4, std::vector<Spectrum>(32), rotation};
    e.radiance[static_cast<std::size_t>(y * 8 + x)] = Spectrum{1};
    return e;
}

TEST(EnvironmentLight, FollowsTheLatLongConvention) {  // u = atan2(z, x)/2π + ½, v = acos(y)/π, row 0 up
    const auto lit = [](int x, int y, Vec3 d, float rotation = 0) {
        const Environment e = one_texel(x, y, rotation);
        return EnvironmentLight(e, 0).radiance({normalize(d)}).r;
    };
    const auto at = [](float u, float v) {
        const float phi = 2 * pi * (u - 0.5f), theta = pi * v;
        return Vec3{std::sin(theta) * std::cos(phi), std::cos(theta), std::sin(theta) * std::sin(phi)};
    };
    EXPECT_NEAR(lit(5, 1, at(5.5f / 8, 1.5f / 4)), 1, 1e-5f);
    EXPECT_NEAR(lit(5, 1, at(6.0f / 8, 1.5f / 4)), 0.5f, 1e-5f);  // halfway to the neighbour
    EXPECT_NEAR(lit(4, 1, {1, 0.414f, 0.414f}), 1, 0.05f);        // +x is u = ½; +z is to its right
    EXPECT_NEAR(lit(0, 0, {-1e-3f, 1, 0}), 0.5f, 2e-2f);          // straight up: between texels 0 and 7
    // Turned counter-clockwise by 90° as seen from +Y, what was at +x is at −z.
    EXPECT_NEAR(lit(4, 1, {0.414f, 0.414f, -1}, pi / 2), 1, 0.05f);
}

TEST(EnvironmentLight, MeanIsTheAverageOverTheSphere) {
    const Environment uniform{16, 8, std::vector<Spectrum>(128, Spectrum{3}), 0};
    EXPECT_NEAR(EnvironmentLight::mean_radiance(uniform), 3, 1e-5f);
}

struct Draws {
    double p, energy_ratio;
};

/// χ² of samples over a grid of directions finer than nothing, and the estimate of ∫ L over its true value.
Draws test_sampling(const Environment& environment, float floor, const EnvironmentLight& pdf_from) {
    const EnvironmentLight light(environment, floor);
    constexpr int rows = 24, columns = 48, draws = 300'000, fine = 8;
    std::vector<double> observed(rows * columns), expected(rows * columns);
    double energy = 0;
    for (std::uint32_t i = 0; i < draws; ++i) {
        const auto s = light.sample(SampleStream{1, i, 1, PointSet::independent}.next2(Dim::light_point));
        const float phi = std::atan2(s.direction.v.z, s.direction.v.x) / (2 * pi) + 0.5f;
        const int row = std::clamp(static_cast<int>((1 - s.direction.v.y) / 2 * rows), 0, rows - 1);
        const int column = std::clamp(static_cast<int>(phi * columns), 0, columns - 1);
        ++observed[static_cast<std::size_t>(row * columns + column)];
        energy += light.radiance(s.direction).r / s.pdf / draws;
    }
    double integral = 0;
    for (int row = 0; row < rows * fine; ++row)
        for (int column = 0; column < columns * fine; ++column) {
            const double z = 1 - 2 * (row + 0.5) / (rows * fine),
                         phi = 2 * 3.14159265358979 * ((column + 0.5) / (columns * fine) - 0.5);
            const double sine = std::sqrt(1 - z * z),
                         area = 4 * 3.14159265358979 / (rows * fine * columns * fine);
            const WorldDir d{{static_cast<float>(sine * std::cos(phi)), static_cast<float>(z),
                              static_cast<float>(sine * std::sin(phi))}};
            expected[static_cast<std::size_t>(row / fine * columns + column / fine)] +=
                draws * area * pdf_from.pdf(d);
            integral += area * light.radiance(d).r;
        }
    return {testing::chi_square_p(observed, expected), energy / integral};
}

TEST(EnvironmentLight, SamplesFollowThePdf) {
    const Environment environment =
        random_environment(12, 6, 0.5f);  // few texels, so that the quadrature resolves them
    const auto [p, energy] = test_sampling(environment, 0, EnvironmentLight(environment, 0));
    EXPECT_GT(p, 1e-6);
    EXPECT_NEAR(energy, 1, 0.01);
    const Environment turned = random_environment(12, 6, 0.55f);
    EXPECT_LT(test_sampling(environment, 0, EnvironmentLight(turned, 0)).p, 1e-6);  // 3° off must be caught
}

TEST(EnvironmentLight, DensityCoversWhateverShines) {
    const Environment e = one_texel(3, 2);
    const EnvironmentLight light(e, 0);
    for (std::uint32_t i = 0; i < 20'000; ++i) {
        const auto [x, y] = SampleStream{2, i, 1, PointSet::independent}.next2(Dim::light_point);
        const float z = 1 - 2 * y, sine = std::sqrt(1 - z * z);
        const WorldDir d{{sine * std::cos(2 * pi * x), z, sine * std::sin(2 * pi * x)}};
        if (light.radiance(d).r > 0) {
            ASSERT_GT(light.pdf(d), 0);
        }
    }
}

/// Of the texels only those count within which the interpolant may exceed the threshold; there weights stay
/// bounded.
TEST(EnvironmentLight, DensityCoversWhateverExceedsTheThreshold) {
    Environment e = random_environment(16, 8, 0.5f);
    const float threshold = 4;  // of values up to 7
    const EnvironmentLight light(e, 0, threshold);
    ASSERT_TRUE(light.can_sample());
    int bright = 0, left_out = 0;
    float heaviest = 0, total = 0;
    constexpr int draws = 100'000;
    for (std::uint32_t i = 0; i < draws; ++i) {
        const auto [x, y] = SampleStream{2, i, 1, PointSet::independent}.next2(Dim::light_point);
        const float z = 1 - 2 * y, sine = std::sqrt(1 - z * z);
        const WorldDir d{{sine * std::cos(2 * pi * x), z, sine * std::sin(2 * pi * x)}};
        const Spectrum radiance = light.radiance(d);
        const float excess = (radiance.r + radiance.g + radiance.b) / 3 - threshold, density = light.pdf(d);
        if (excess > 0) {
            ASSERT_GT(density, 0);
            heaviest = std::max(heaviest, excess / density);
            total += excess * 4 * pi / draws;
        }
        bright += excess > 0;
        left_out += !(density > 0);
    }
    EXPECT_GT(bright, draws / 200);
    EXPECT_GT(left_out, draws / 50);
    EXPECT_LT(heaviest, 30 * total);
    for (std::uint32_t i = 0; i < 10'000; ++i) {
        const auto s = light.sample(SampleStream{3, i, 1, PointSet::independent}.next2(Dim::light_point));
        ASSERT_NEAR(light.pdf(s.direction), s.pdf, 2e-3f * s.pdf);
    }
    EXPECT_FALSE(EnvironmentLight(e, 0, 8).can_sample());
}

TEST(EnvironmentLight, AUniformSkyNeedsNoSamplesWhenCompensated) {
    const Environment uniform{16, 8, std::vector<Spectrum>(128, Spectrum{3}), 0};
    EXPECT_FALSE(EnvironmentLight(uniform, EnvironmentLight::mean_radiance(uniform) * 1.0001f).can_sample());
    EXPECT_TRUE(EnvironmentLight(uniform, 0).can_sample());
}

}  // namespace
}  // namespace relumine
