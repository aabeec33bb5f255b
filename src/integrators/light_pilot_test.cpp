// SPDX-License-Identifier: Apache-2.0
// How many rays a pixel gets: from its neighbours, never from what its own have found.
#include "integrators/light_pilot.hpp"

#include <gtest/gtest.h>

#include "integrators/cache_plan.hpp"

namespace relumine {
namespace {

constexpr int width = 6, height = 5;

/// Four light samples, of which some are lit by 1 each.
FoundLight found(int lit) {
    FoundLight light;
    light.rays = light.noise.rays = 4;
    for (int i = 0; i < lit; ++i) light.noise.count(i % 2 == 1, 0.25f);
    light.radiance = Spectrum{0.25f * static_cast<float>(lit)};
    return light;
}

std::vector<PilotLight> cell_with(int lit) {
    std::vector<PilotLight> cell(std::size_t{width} * height);
    for (PilotLight& pilot : cell) pilot.add(found(lit), 1);
    return cell;
}

TEST(LightPilot, ExpectsWhatItsNeighboursFound) {
    const ExpectedLight half = expected_light(cell_with(2), width, 0, 0);
    EXPECT_TRUE(half.known);
    EXPECT_NEAR(half.mean, 0.5f, 1e-6f);
    EXPECT_NEAR(half.deviation, std::sqrt(0.25f / 3), 1e-6f);  // of the mean of 4 of variance 1/3
    EXPECT_EQ(expected_light(cell_with(4), width, 3, 2).deviation, 0);
}

TEST(LightPilot, LeavesItsOwnOut) {
    std::vector<PilotLight> cell = cell_with(4);
    const ExpectedLight before = expected_light(cell, width, 2, 2);
    cell[2 * width + 2] = {};
    cell[2 * width + 2].add(found(1), 100);
    const ExpectedLight after = expected_light(cell, width, 2, 2), beside = expected_light(cell, width, 3, 2);
    EXPECT_EQ(after.mean, before.mean);
    EXPECT_EQ(after.deviation, before.deviation);
    EXPECT_GT(beside.deviation, 1);  // this one is warned
}

TEST(LightPilot, KnowsNothingAlone) {
    std::vector<PilotLight> cell(std::size_t{width} * height);
    cell[0].add(found(2), 1);
    EXPECT_FALSE(expected_light(cell, width, 0, 0).known);
    EXPECT_FALSE(expected_light(cell, width, 5, 4).known);  // too far away
    EXPECT_TRUE(expected_light(cell, width, 1, 1).known);
}

TEST(FoundLight, SeriesCountByTheirRays) {
    FoundLight sum = found(4), other = found(0);
    other.rays = other.noise.rays = 12;
    sum.join(other);
    EXPECT_FLOAT_EQ(sum.radiance.r, 0.25f);
    EXPECT_FLOAT_EQ(sum.rays, 16);
    EXPECT_FLOAT_EQ(sum.noise.halves[0] + sum.noise.halves[1], 0.25f);
    FoundLight none;
    none.join(FoundLight{});
    EXPECT_EQ(none.rays, 0);
}

TEST(RayDemand, GrowsWithTheDoubtAndTheWantedPrecision) {
    RenderSettings settings;
    const auto residual = [&](float error, float doubt) {
        settings.error = error;
        return cache_plan(settings).demand.residual_rays(doubt);
    };
    EXPECT_EQ(residual(0.5f, 0.01f), 1);
    EXPECT_EQ(residual(0.02f, 0), 1);
    EXPECT_EQ(residual(0.01f, 0.5f), 4 * residual(0.02f, 0.5f));
    EXPECT_EQ(residual(0.02f, 0.5f), 16 * residual(0.02f, 0.125f));
    EXPECT_EQ(residual(0.0005f, 100), 4096);
    settings.unbiased = true;
    EXPECT_GT(cache_plan(settings).demand.residual_rays(1), 0);
}

TEST(RayDemand, AddsLightSamplesWhereTheyScatter) {
    RenderSettings settings;
    const RayDemand demand = cache_plan(settings).demand;
    EXPECT_TRUE(demand.light_adapts && demand.residual_adapts);
    EXPECT_EQ(demand.more_light(0), 0);
    EXPECT_EQ(demand.more_light(demand.sigma / 2), 0);
    EXPECT_GE(demand.more_light(0.5f), 16 * demand.pilot);
    settings.light_samples = settings.residual_rays = 7;
    EXPECT_FALSE(cache_plan(settings).demand.light_adapts || cache_plan(settings).demand.residual_adapts);
}

TEST(CachePlan, LeavesOutThePartsNamed) {
    const RenderSettings whole;
    const auto left_out = [](const char* part) {
        RenderSettings settings;
        settings.without = {part};
        return cache_plan(settings);
    };
    EXPECT_GT(cache_plan(whole).reprojected, 0u);
    EXPECT_EQ(left_out("reprojection").reprojected, 0u);
    EXPECT_LT(cache_plan(whole).blocks.smallest, cache_plan(whole).blocks.largest);
    EXPECT_EQ(left_out("splits").blocks.smallest, left_out("splits").blocks.largest);
    EXPECT_TRUE(cache_plan(whole).blends);
    EXPECT_FALSE(left_out("blending").blends);
    EXPECT_GT(cache_plan(whole).sharp_alpha, 0);
    EXPECT_EQ(left_out("sharp-lobes").sharp_alpha, 0);
}

}  // namespace
}  // namespace relumine
