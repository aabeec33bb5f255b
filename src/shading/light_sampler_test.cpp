// SPDX-License-Identifier: Apache-2.0
// Drawing lights: uniform over their area, densities that integrate, groups that all get their share.
#include "shading/light_sampler.hpp"

#include <gtest/gtest.h>

#include "base/sample_stream.hpp"
#include "shading/delta_lights.hpp"
#include "tests/statistics.hpp"

namespace relumine {
namespace {

constexpr int draws = 200'000;

/// A square light of side 2 at height 1 that shines down, and nothing else.
SceneData square_light() {
    SceneData scene;
    Material light;
    light.emission = Spectrum{3};
    scene.materials.push_back(light);
    Mesh mesh;
    mesh.positions = {{-1, 1, -1}, {1, 1, -1}, {1, 1, 1}, {-1, 1, 1}};
    mesh.triangles = {{{0, 1, 2}}, {{0, 2, 3}}};
    scene.meshes.push_back(mesh);
    Instance instance;
    instance.identity = true;
    scene.instances.push_back(instance);
    scene.bounds.add({-1, 0, -1});
    scene.bounds.add({1, 1, 1});
    return scene;
}

struct Numbers {
    float choice;
    Point2 point;
};
Numbers numbers(std::uint32_t i) {
    const SampleStream stream{7, i, 1, PointSet::independent};
    return {stream.next1(Dim::light_choice), stream.next2(Dim::light_point)};
}

TEST(LightSampler, PointsAreUniformOverTheLight) {
    const SceneData scene = square_light();
    const LightSampler lights(scene, {});
    const auto p_of_grid = [&](auto squeeze) {
        constexpr int side = 10;
        std::vector<double> observed(side * side), expected(side * side, double{draws} / (side * side));
        for (std::uint32_t i = 0; i < draws; ++i) {
            const auto [choice, point] = numbers(i);
            const auto s = lights.sample({0, 0, 0}, choice, squeeze(point));
            const int x = std::clamp(static_cast<int>((s->target.x + 1) / 2 * side), 0, side - 1);
            const int z = std::clamp(static_cast<int>((s->target.z + 1) / 2 * side), 0, side - 1);
            ++observed[static_cast<std::size_t>(z * side + x)];
        }
        return testing::chi_square_p(observed, expected);
    };
    EXPECT_GT(p_of_grid([](Point2 u) { return u; }), 1e-6);
    EXPECT_LT(p_of_grid([](Point2 u) { return Point2{0.99f * u.x, u.y}; }), 1e-6);  // 1 % of the square left out must be caught
}

/// Irradiance at the origin facing up, by sampling; `bias` multiplies the density.
testing::Estimate irradiance(const LightSampler& lights, Vec3 from, double bias = 1) {
    std::vector<double> values;
    for (std::uint32_t i = 0; i < draws; ++i) {
        const auto [choice, point] = numbers(i);
        const auto s = lights.sample(from, choice, point);
        values.push_back(s ? std::max(0.0f, s->w_in.v.y) * s->radiance.g / (s->pdf * bias) : 0.0);
    }
    return testing::estimate(values);
}

TEST(LightSampler, DensityIntegratesToTheFormFactor) {
    const SceneData scene = square_light();
    // Of a square of half side a = 1 at height h = 1 over its centre: F = 4/π · a/√(a²+h²) · atan(a/√(a²+h²)) [Howell, C-11]
    const double s = 1 / std::sqrt(2.0), expected = 3 * 4 * s * std::atan(s);
    const auto [mean, error, count] = irradiance(LightSampler(scene, {}), {0, 0, 0});
    EXPECT_LT(std::abs(mean - expected), 5 * error);
    EXPECT_GT(std::abs(irradiance(LightSampler(scene, {}), {0, 0, 0}, 1.02).mean - expected), 5 * error);  // 2 % must be caught
}

TEST(LightSampler, PdfOfAHitIsThatOfTheSample) {
    const SceneData scene = square_light();
    const LightSampler lights(scene, {});
    for (std::uint32_t i = 0; i < 100; ++i) {
        const auto [choice, point] = numbers(i);
        const Vec3 from{0.3f, -0.2f, 0.1f};
        const auto s = lights.sample(from, choice, point);
        SurfacePoint hit;
        hit.position = from + s->w_in.v * s->distance;
        hit.triangle = hit.position.x > hit.position.z ? 0 : 1;
        EXPECT_NEAR(lights.pdf(from, hit) / s->pdf, 1, 1e-3);
    }
}

TEST(LightSampler, TheBackOfASingleSidedLightIsDark) {
    const SceneData scene = square_light();
    const LightSampler lights(scene, {});
    for (std::uint32_t i = 0; i < 100; ++i) EXPECT_FALSE(lights.sample({0, 2, 0}, numbers(i).choice, numbers(i).point));
}

TEST(LightSampler, DeltaLightsArriveWithTheirProbability) {
    SceneData scene = square_light();
    scene.materials[0].emission = {};
    scene.point_lights.push_back({{0, 2, 0}, Spectrum{4}});
    scene.directional_lights.push_back({{0, -1, 0}, Spectrum{2}});
    const auto [mean, error, count] = irradiance(LightSampler(scene, {}), {0, 0, 0});
    EXPECT_LT(std::abs(mean - (4.0 / 4 + 2)), 5 * error);
    EXPECT_EQ(delta_light_samples(scene, {0, 0, 0}).size(), 2u);
    LightSelection no_delta;
    no_delta.delta_lights = false;
    EXPECT_TRUE(LightSampler(scene, no_delta).empty());
}

TEST(LightSampler, SkyAndLampShareTheSamples) {
    SceneData scene = square_light();
    Environment sky{4, 2, std::vector<Spectrum>(8, Spectrum{0.1f}), 0};
    sky.radiance[0] = Spectrum{100};
    scene.environment = sky;
    const LightSampler lights(scene, {});
    int from_sky = 0;
    for (std::uint32_t i = 0; i < 10'000; ++i) {
        const auto s = lights.sample({0, 0, 0}, numbers(i).choice, numbers(i).point);
        from_sky += s && !std::isfinite(s->distance) ? 1 : 0;
    }
    EXPECT_GT(from_sky, 2500);
    EXPECT_LT(from_sky, 7500);
}

TEST(SpotLight, ConeIsOneInsideAndZeroOutside) {
    const SpotLight spot{{0, 1, 0}, {0, -1, 0}, Spectrum{1}, 0.9f, 0.8f};
    EXPECT_NEAR(light_sample(spot, {0, 0, 0})->radiance.r, 1, 1e-6f);
    EXPECT_FALSE(light_sample(spot, {2, 0, 0}));
    const auto between = light_sample(spot, {0.62f, 0, 0});  // cos = .85
    ASSERT_TRUE(between);
    EXPECT_NEAR(between->radiance.r * sqr(between->distance), 0.25f, 0.01f);
}

}  // namespace
}  // namespace relumine
