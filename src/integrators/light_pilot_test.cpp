// SPDX-License-Identifier: Apache-2.0
// How many rays a pixel gets: from its neighbours, never from what its own have found.
#include "integrators/light_pilot.hpp"

#include <gtest/gtest.h>

#include <limits>

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
    EXPECT_EQ(residual(0.02f, 0), 16);
    EXPECT_EQ(residual(0.01f, 0), 32);
    EXPECT_EQ(residual(0.01f, 0.5f), 4 * residual(0.02f, 0.5f));
    EXPECT_EQ(residual(0.02f, 0.5f), residual(0.02f, 2) / 16);
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

/// Of one camera sample with four rays, of which one finds `found` and the others nothing; `expected` of one.
PilotResidual residual_pilot(const Material& seen, float found, float expected) {
    FoundResidual residual;
    residual.bright.rays = residual.noise.rays = 4;
    residual.noise.count(false, found / 4);
    ShadingPoint point;
    point.path.throughput = Spectrum{1};
    point.vertex.point.material = &seen;
    PilotResidual pilot;
    pilot.add(residual, expected, point);
    return pilot;
}

TEST(ResidualScatter, ComparesWhatIsFoundWithWhatWasExpected) {
    const Material matte;
    const std::vector<PilotResidual> cell(9, residual_pilot(matte, 4, 1));
    const float of_one = std::sqrt(4.0f);  // 16/4 of squares, (4/4)² of the mean, by 4/3: a variance of 4
    EXPECT_NEAR(ResidualScatter(cell).without(cell[0]), of_one, 1e-5f);
    const std::vector<PilotResidual> calm(9, residual_pilot(matte, 4, 8));
    EXPECT_NEAR(ResidualScatter(calm).without(calm[0]), of_one / 8, 1e-5f);
}

TEST(ResidualScatter, LeavesItsOwnAndOtherSurfacesOut) {
    const Material matte, metal;
    std::vector<PilotResidual> cell(9, residual_pilot(matte, 4, 1));
    const float before = ResidualScatter(cell).without(cell[4]);
    cell[4] = residual_pilot(matte, 4e3f, 1);
    cell.push_back(residual_pilot(metal, 4e3f, 1));
    const ResidualScatter scatter(cell);
    EXPECT_NEAR(scatter.without(cell[4]), before, 1e-4f);
    EXPECT_GT(scatter.without(cell[0]), 100);
    EXPECT_EQ(scatter.without(cell.back()), 1);  // nobody else knows
}

TEST(ResidualScatter, AsksForRaysInProportion) {
    EXPECT_EQ(RayDemand::more_residual(1, 32), 0);
    EXPECT_EQ(RayDemand::more_residual(2, 32), 0);
    const float three = RayDemand::more_residual(3, 32), five = RayDemand::more_residual(7.5f, 32);
    EXPECT_EQ(three, 32);
    EXPECT_EQ(five, 4 * three);
    EXPECT_LE(RayDemand::more_residual(1e6f, 32), 8 * 32);
    EXPECT_EQ(RayDemand::more_residual(std::numeric_limits<float>::quiet_NaN(), 32), 0);
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
