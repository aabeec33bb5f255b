// SPDX-License-Identifier: Apache-2.0
// The tabulated environment: means, tier by tier, in the order of the quadrature's points.
#include "blocks/dim_environment.hpp"

#include <gtest/gtest.h>

#include "base/hash.hpp"
#include "cache/test_stage.hpp"

namespace relumine {
namespace {

using testing::Stage;

/// Blurred noise with a sun.
Environment sky_with_sun() {
    Environment e{32, 16, {}, 0.7f};
    for (std::uint64_t i = 0; i < 32 * 16; ++i) {
        const float x = unit_float(static_cast<std::uint32_t>(hash(i, 1)));
        e.radiance.emplace_back(x, 0.3f + x * x, 1 - 0.5f * x);
    }
    e.radiance[5 * 32 + 9] = Spectrum{15, 14, 11};
    return e;
}

class DimSky : public ::testing::Test {
  protected:
    const Stage stage{{}, sky_with_sun()};
    const BrightSplit split{stage.scene(), 8};
    const DirectionGrid grid{16};
    const DimEnvironment environment{stage.transport(), split, grid, 2};

    [[nodiscard]] Spectrum dim(WorldDir d) const {
        const Spectrum radiance = stage.transport().lights.environment_radiance(d);
        return radiance * (1 - split.of_environment(d, radiance).share);
    }
    /// The mean over a texel by many points.
    [[nodiscard]] Spectrum brute_force(const DirectionGrid& g, std::uint32_t texel) const {
        constexpr int points = 64;
        Spectrum sum;
        for (int i = 0; i < points * points; ++i)
            sum += dim(g.direction_in(texel, {(static_cast<float>(i % points) + 0.5f) / points,
                                              (static_cast<float>(i / points) + 0.5f) / points}));
        return sum / (points * points);
    }
};

TEST_F(DimSky, HoldsTheMeanOfEveryTexel) {
    ASSERT_EQ(environment.texels.size(), grid.texels);
    ASSERT_FALSE(split.empty());
    double luminances = 0;
    for (std::uint32_t texel = 0; texel < grid.texels; ++texel) {
        const Spectrum expected = brute_force(grid, texel), found = environment.texels[texel];
        const float tolerance = 0.02f * luminance(expected) + 0.004f;
        ASSERT_NEAR(found.r, expected.r, tolerance) << texel;
        ASSERT_NEAR(found.g, expected.g, tolerance) << texel;
        ASSERT_NEAR(found.b, expected.b, tolerance) << texel;
        luminances += luminance(found) / static_cast<double>(grid.texels);
    }
    EXPECT_NEAR(environment.luminance, luminances, 1e-5);
}

TEST_F(DimSky, HoldsFinerMeansWhoseMeansAreTheTexels) {
    for (std::size_t tier = 0; tier < fine_tiers.size(); ++tier) {
        const std::size_t per_texel = points_per_texel(tier);
        const RadianceRuns& points = environment.points[tier];
        ASSERT_EQ(points.r.size(), grid.texels * per_texel);
        for (std::size_t texel = 0; texel < grid.texels; ++texel) {
            Spectrum sum;
            for (std::size_t point = texel * per_texel; point < (texel + 1) * per_texel; ++point) {
                const std::size_t at = run_position(point, per_texel);
                sum += Spectrum{points.r[at], points.g[at], points.b[at]};
            }
            const Spectrum expected = environment.texels[texel];
            ASSERT_NEAR(sum.r / static_cast<float>(per_texel), expected.r, 2e-6f * expected.r);
            ASSERT_NEAR(sum.g / static_cast<float>(per_texel), expected.g, 2e-6f * expected.g);
            ASSERT_NEAR(sum.b / static_cast<float>(per_texel), expected.b, 2e-6f * expected.b);
        }
    }
}

TEST_F(DimSky, HasItsPointsWhereTheQuadratureHasThem) {
    const QuadraturePoints points(grid);
    for (std::size_t tier = 0; tier < fine_tiers.size(); ++tier) {
        const DirectionGrid finer(grid.side << tier);
        const DirectionRuns& runs = points.tiers[tier];
        ASSERT_EQ(runs.x.size(), finer.texels);
        std::vector<bool> met(finer.texels);
        for (std::size_t at = 0; at < finer.texels; ++at) {
            const std::uint32_t texel = finer.texel_at({{runs.x[at], runs.y[at], runs.z[at]}});
            met[texel] = true;
            // Run r belongs to tile r / per_texel, its lane i to the tile's texel i.
            const std::size_t tile = at / tile_texels / points_per_texel(tier);
            ASSERT_EQ(texel / points_per_texel(tier), tile * tile_texels + at % tile_texels);
            if (at % 7 != 0) continue;
            const Spectrum expected = brute_force(finer, texel);
            ASSERT_NEAR(environment.points[tier].r[at], expected.r, 0.05f * expected.r + 0.01f);
            ASSERT_NEAR(environment.points[tier].b[at], expected.b, 0.05f * expected.b + 0.01f);
        }
        EXPECT_EQ(std::ranges::count(met, true), static_cast<std::ptrdiff_t>(finer.texels));
    }
}

TEST_F(DimSky, IsTheSameForAnyNumberOfThreads) {
    const DimEnvironment again(stage.transport(), split, grid, 7);
    EXPECT_EQ(environment.texels, again.texels);
    EXPECT_EQ(environment.luminance, again.luminance);
}

TEST(DimEnvironment, IsBlackWithoutAnEnvironment) {
    const Stage stage({}, Spectrum{});
    const BrightSplit split(stage.scene(), 8);
    const DirectionGrid grid(16);
    const DimEnvironment environment(stage.transport(), split, grid, 1);
    EXPECT_EQ(environment.texels, std::vector<Spectrum>(grid.texels));
    EXPECT_EQ(environment.luminance, 0);
}

}  // namespace
}  // namespace relumine
