// SPDX-License-Identifier: Apache-2.0
// Splitting light: the bright part can be sampled, with bounded weights, and adds up with the rest.
#include "blocks/bright_split.hpp"

#include <gtest/gtest.h>

#include "base/sample_stream.hpp"
#include "cache/test_stage.hpp"

namespace relumine {
namespace {

using testing::Quad;
using testing::Stage;

constexpr float factor = 8;

/// A dim sky with a sun of a few texels beside a fainter one.
Environment sunny() {
    Environment e{64, 32, {}, 0.4f};
    for (std::uint64_t i = 0; i < 64 * 32; ++i)
        e.radiance.emplace_back(0.5f + unit_float(static_cast<std::uint32_t>(mix(i))), 1.0f, 0.8f);
    const auto at = [&](std::size_t x, std::size_t y) -> Spectrum& { return e.radiance[y * 64 + x]; };
    at(20, 8) = Spectrum{400, 350, 250};
    at(21, 8) = Spectrum{200, 150, 100};
    at(45, 14) = Spectrum{90};
    at(63, 0) = Spectrum{300};  // beside the seam and the pole
    return e;
}

float mean(Spectrum s) { return (s.r + s.g + s.b) / 3; }

/// Runs `visit` with evenly spread directions and the solid angle of each.
template <typename Visit>
void over_sphere(const Visit& visit) {
    constexpr int rows = 600, columns = 1200;
    for (int row = 0; row < rows; ++row)
        for (int column = 0; column < columns; ++column) {
            const float z = 1 - 2 * (static_cast<float>(row) + 0.5f) / rows,
                        phi = 2 * pi * (static_cast<float>(column) + 0.5f) / columns,
                        r = std::sqrt(1 - z * z);
            visit(WorldDir{{r * std::cos(phi), z, r * std::sin(phi)}}, 4 * pi / (rows * columns));
        }
}

TEST(BrightSplit, TakesWhatRisesOverTheThresholdAndCanSampleIt) {
    const Stage stage({}, sunny());
    const BrightSplit split(stage.scene(), factor);
    const float threshold = bright_threshold(stage.scene(), factor);
    ASSERT_FALSE(split.empty());
    int bright = 0;
    over_sphere([&](WorldDir d, float) {
        const Spectrum radiance = stage.transport().lights.environment_radiance(d);
        const BrightSplit::Part part = split.of_environment(d, radiance);
        ASSERT_GE(part.share, 0);
        ASSERT_LE(part.share, 1);
        ASSERT_EQ(part.share > 0, part.pdf > 0);
        ASSERT_EQ(part.share > 0, mean(radiance) > threshold);
        ASSERT_LE(mean(radiance * (1 - part.share)), threshold * 1.00001f);
        bright += part.share > 0;
    });
    EXPECT_GT(bright, 300);
}

TEST(BrightSplit, WeighsNoSampleMuchMoreThanTheMean) {
    const Stage stage({}, sunny());
    const BrightSplit split(stage.scene(), factor);
    double whole = 0;
    float most = 0;
    over_sphere([&](WorldDir d, float solid_angle) {
        const Spectrum radiance = stage.transport().lights.environment_radiance(d);
        const BrightSplit::Part part = split.of_environment(d, radiance);
        whole += mean(radiance) * part.share * solid_angle;
        if (part.share > 0) most = std::max(most, mean(radiance) * part.share / part.pdf);
    });
    // Beside a lone peak the interpolant rises to 16 times a texel's mean, at the corner.
    EXPECT_LT(most, 20 * whole);
}

TEST(BrightSplit, LightSamplesFindAllOfIt) {
    const Stage stage({}, sunny());
    const BrightSplit split(stage.scene(), factor);
    double expected = 0, whole = 0, sampled = 0;
    over_sphere([&](WorldDir d, float solid_angle) {
        const Spectrum radiance = stage.transport().lights.environment_radiance(d);
        expected += mean(radiance) * split.of_environment(d, radiance).share * solid_angle;
        whole += mean(radiance) * solid_angle;
    });
    constexpr std::uint32_t draws = 1 << 17;
    for (std::uint32_t i = 0; i < draws; ++i) {
        const auto s = split.lights().sample({}, SampleStream{3, i}.next2(Dim::light_point));
        ASSERT_TRUE(s && s->pdf > 0);
        ASSERT_FALSE(s->delta);
        ASSERT_NEAR(split.lights().environment_pdf(s->w_in), s->pdf, 2e-3f * s->pdf);
        sampled += mean(s->radiance) * split.share(*s) / s->pdf / draws;
    }
    EXPECT_NEAR(sampled, expected, 0.003 * expected);
    EXPECT_GT(expected, 0.05 * whole);  // a part left out would show
    EXPECT_LT(expected, 0.95 * whole);
}

TEST(BrightSplit, AnEvenSkyHasNoBrightPart) {
    const Stage stage({}, Spectrum{3});
    const BrightSplit split(stage.scene(), factor);
    EXPECT_TRUE(split.empty());
    over_sphere([&](WorldDir d, float) { ASSERT_EQ(split.of_environment(d, Spectrum{3}).share, 0); });
}

TEST(BrightSplit, EmittersAreBrightAsAWholeOrNotAtAll) {
    const Quad lamp{{-1, -1, 2}, {0, 2, 0}, {2, 0, 0}, Spectrum{50}};
    const Quad panel{{-1, -1, -2}, {2, 0, 0}, {0, 2, 0}, Spectrum{2}};
    const Stage stage({lamp, panel}, Spectrum{1});
    const BrightSplit split(stage.scene(), factor);
    const auto part = [&](Vec3 direction) {
        const Ray ray{{}, {direction}, infinity, 0};
        const Hit hit = stage.transport().tracer.closest_hit(ray);
        EXPECT_TRUE(static_cast<bool>(hit));
        return split.of_emission(ray, hit);
    };
    EXPECT_EQ(part(normalize({0.1f, 0.2f, 1})).share, 1);
    EXPECT_NEAR(part({0, 0, 1}).pdf, 1.0f / 4 * 4, 1e-4f);  // r² / (A cos θ), r = 2, A = 4
    EXPECT_EQ(part(normalize({0.1f, 0.2f, -1})).share, 0);
    EXPECT_EQ(part(normalize({0.1f, 0.2f, -1})).pdf, 0);
    const auto s = split.lights().sample({}, {0.3f, 0.6f});
    ASSERT_TRUE(s);
    EXPECT_EQ(split.share(*s), 1);
    EXPECT_GT(s->w_in.v.z, 0);

    const Stage dark({lamp, panel}, Spectrum{});  // without an environment all emitters are
    const BrightSplit all(dark.scene(), factor);
    const Ray down{{}, {{0, 0, -1}}, infinity, 0};
    EXPECT_EQ(all.of_emission(down, dark.transport().tracer.closest_hit(down)).share, 1);
}

}  // namespace
}  // namespace relumine
