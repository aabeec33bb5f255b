// SPDX-License-Identifier: Apache-2.0
// Drawing residual rays: a density over the sphere, and samples that follow it.
#include "blocks/residual_distribution.hpp"

#include <gtest/gtest.h>

#include "base/sample_stream.hpp"
#include "blocks/test_maps.hpp"
#include "tests/statistics.hpp"

namespace relumine {
namespace {

using testing::MapStage;
using testing::random_map;

constexpr Frame world{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};

Vertex vertex_of(const Bsdf& bsdf, Vec3 normal) {
    Vertex vertex{{}, {normalize({0.3f, 0.4f, 0.6f})}, bsdf};
    vertex.point.frame = frame_around(normal);
    vertex.point.geometric_normal = normal;
    return vertex;
}

class ResidualDistributions : public ::testing::TestWithParam<bool> {  // exact
  protected:
    const MapStage stage{{}, testing::even_sky(Spectrum{1}), 32};
    const DirectionGrid& grid = stage.grid();
    const QuadraturePoints points{grid};
    const std::vector<BlockMap> maps{random_map(grid, 3), random_map(grid, 300)};
    const Bsdf metal = RoughConductor{Spectrum{0.9f}, {0.15f, Masking::correlated}};

    [[nodiscard]] MapIntegral integral(const Bsdf& bsdf, Vec3 normal = normalize({0.2f, -0.3f, 0.9f})) const {
        Blend blend;
        for (const BlockMap& map : maps) blend.add(map, 1);
        blend.normalize();
        const Vertex vertex = vertex_of(bsdf, normal);
        MapIntegral integral(grid, points, stage.environment(), GetParam());
        integral.run(blend, *receiver_bsdf(vertex, world), normal);
        integral.estimate_deviations();
        return integral;
    }
    /// χ² over all texels of samples from one distribution against the density of another.
    [[nodiscard]] double sampling_p(const ResidualDistribution& drawn,
                                    const ResidualDistribution& stated) const {
        constexpr std::uint32_t draws = 400'000;
        std::vector<double> observed(grid.texels), expected(grid.texels);
        for (std::uint32_t i = 0; i < draws; ++i)
            ++observed[drawn.sample(SampleStream{5, i, 1, PointSet::independent}.next2(Dim::direction))
                           .texel];
        for (std::uint32_t texel = 0; texel < grid.texels; ++texel)
            expected[texel] = double{stated.pdf(texel)} * grid.texel_solid_angle * draws;
        return testing::chi_square_p(observed, expected);
    }
};
INSTANTIATE_TEST_SUITE_P(Exact, ResidualDistributions, ::testing::Bool());

TEST_P(ResidualDistributions, IntegrateToOne) {
    for (const Bsdf& bsdf : {Bsdf{Lambert{Spectrum{0.5f}}}, metal}) {
        const MapIntegral of = integral(bsdf);
        ResidualDistribution distribution(grid);
        distribution.build(of);
        EXPECT_FALSE(distribution.empty());
        double sum = 0;
        for (std::uint32_t texel = 0; texel < grid.texels; ++texel)
            sum += double{distribution.pdf(texel)} * grid.texel_solid_angle;
        EXPECT_NEAR(sum, 1, 1e-4);
    }
}

TEST_P(ResidualDistributions, DrawFromTheirDensity) {  // χ² over 1024 texels, α = 1e-6
    for (const Bsdf& bsdf : {Bsdf{Lambert{Spectrum{0.5f}}}, metal}) {
        const MapIntegral of = integral(bsdf), tilted = integral(bsdf, normalize({0.25f, -0.3f, 0.9f}));
        ResidualDistribution distribution(grid), mutant(grid);
        distribution.build(of);
        mutant.build(tilted);
        EXPECT_GT(sampling_p(distribution, distribution), 1e-6);
        EXPECT_LT(sampling_p(distribution, mutant), 1e-6);  // 3° off must be caught
    }
}

TEST_P(ResidualDistributions, TellTheDensityOfTheirSamples) {
    const MapIntegral of = integral(metal);
    ResidualDistribution distribution(grid);
    distribution.build(of);
    int at_border = 0;
    constexpr std::uint32_t draws = 20'000;
    for (std::uint32_t i = 0; i < draws; ++i) {
        const ResidualSample s = distribution.sample(SampleStream{6, i}.next2(Dim::direction));
        ASSERT_GT(s.pdf, 0);
        ASSERT_EQ(s.pdf, distribution.pdf(s.texel));
        ASSERT_LT(length(s.direction.v - grid.texel_center(s.texel).v),
                  2 * std::sqrt(grid.texel_solid_angle));
        at_border += grid.texel_at(s.direction) != s.texel;  // rounding
    }
    EXPECT_LT(at_border, 10);
}

/// Well spread points stay so: every tile gets its share to within a few samples.
TEST_P(ResidualDistributions, KeepPointsSpread) {
    const MapIntegral of = integral(Lambert{Spectrum{0.5f}});
    ResidualDistribution distribution(grid);
    distribution.build(of);
    constexpr std::uint32_t draws = 1 << 14;
    std::vector<double> count(grid.tiles), share(grid.tiles);
    for (std::uint32_t i = 0; i < draws; ++i)
        ++count[distribution.sample(SampleStream{7, i}.next2(Dim::direction)).texel / tile_texels];
    double squares = 0, poisson = 0;
    for (std::uint32_t texel = 0; texel < grid.texels; ++texel)
        share[texel / tile_texels] += double{distribution.pdf(texel)} * grid.texel_solid_angle * draws;
    for (std::size_t tile = 0; tile < grid.tiles; ++tile) {
        squares += (count[tile] - share[tile]) * (count[tile] - share[tile]);
        poisson += share[tile];
    }
    EXPECT_LT(squares, 0.1 * poisson);
}

TEST_P(ResidualDistributions, AreEmptyWhereNothingIsReflected) {
    const MapIntegral of = integral(Lambert{Spectrum{}});
    ResidualDistribution distribution(grid);
    distribution.build(of);
    EXPECT_TRUE(distribution.empty());
    for (std::uint32_t texel = 0; texel < grid.texels; ++texel) ASSERT_EQ(distribution.pdf(texel), 0);
}

}  // namespace
}  // namespace relumine
