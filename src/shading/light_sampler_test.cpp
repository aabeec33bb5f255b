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

/// χ² over a 10 × 10 grid on the light, of points that `draw` makes of each pair of numbers.
template <typename Draw>
double p_of_grid(const Draw& draw) {
    constexpr int side = 10;
    std::vector<double> observed(side * side), expected(side * side, double{draws} / (side * side));
    for (std::uint32_t i = 0; i < draws; ++i) {
        const std::optional<LightSample> s = draw(numbers(i));
        const int x = std::clamp(static_cast<int>((s->target.x + 1) / 2 * side), 0, side - 1);
        const int z = std::clamp(static_cast<int>((s->target.z + 1) / 2 * side), 0, side - 1);
        ++observed[static_cast<std::size_t>(z * side + x)];
    }
    return testing::chi_square_p(observed, expected);
}

TEST(LightSampler, PointsAreUniformOverTheLight) {
    const SceneData scene = square_light();
    const LightSampler lights(scene, {});
    const auto p = [&](auto squeeze) {
        return p_of_grid([&](Numbers n) { return lights.sample({0, 0, 0}, n.choice, squeeze(n.point)); });
    };
    EXPECT_GT(p([](Point2 u) { return u; }), 1e-6);
    EXPECT_LT(p([](Point2 u) {
                  return Point2{0.99f * u.x, u.y};
              }),
              1e-6);  // 1 % of the square left out must be caught
}

TEST(LightSampler, PointsAreUniformWhereTwoNumbersDoForThree) {
    const SceneData scene = square_light();
    const LightSampler lights(scene, {});
    const auto p = [&](auto squeeze) {
        return p_of_grid([&](Numbers n) { return lights.sample({0, 0, 0}, squeeze(n.point)); });
    };
    EXPECT_GT(p([](Point2 u) { return u; }), 1e-6);
    EXPECT_LT(p([](Point2 u) { return Point2{u.x, 0.99f * u.y}; }), 1e-6);
}

TEST(LightSampler, BothHalvesOfASquareGetTheSameNumberOfSobolPoints) {
    const SceneData scene = square_light();
    const LightSampler lights(scene, {});
    for (std::uint64_t key = 0; key < 16; ++key) {
        int of_first = 0;
        for (std::uint32_t i = 0; i < 64; ++i) {
            const auto s = lights.sample(
                {0, 0, 0}, SampleStream{mix(key), i, 64, PointSet::sobol}.next2(Dim::light_point));
            of_first += s->target.x > s->target.z ? 1 : 0;
        }
        EXPECT_EQ(of_first, 32);
    }
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
    // Of a square of half side a = 1 at height h = 1 over its centre: F = 4/π · a/√(a²+h²) · atan(a/√(a²+h²))
    // [Howell, C-11]
    const double s = 1 / std::sqrt(2.0), expected = 3 * 4 * s * std::atan(s);
    const auto [mean, error, count] = irradiance(LightSampler(scene, {}), {0, 0, 0});
    EXPECT_LT(std::abs(mean - expected), 5 * error);
    EXPECT_GT(std::abs(irradiance(LightSampler(scene, {}), {0, 0, 0}, 1.02).mean - expected),
              5 * error);  // 2 % must be caught
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
    for (std::uint32_t i = 0; i < 100; ++i)
        EXPECT_FALSE(lights.sample({0, 2, 0}, numbers(i).choice, numbers(i).point));
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

TEST(LightSampler, TwoNumbersReachSkyLampAndPointLights) {
    SceneData scene = square_light();
    scene.point_lights.push_back({{0, 2, 0}, Spectrum{4}});
    Environment sky{4, 2, std::vector<Spectrum>(8, Spectrum{0.5f}), 0};
    sky.radiance[0] = Spectrum{2};
    scene.environment = sky;
    LightSelection whole;
    whole.compensate_for_mis = false;  // a density that covers the whole sky
    const LightSampler lights(scene, whole);
    const auto estimates = [&](double bias) {
        std::vector<double> difference;
        for (std::uint32_t i = 0; i < draws; ++i) {
            const auto [choice, point] = numbers(i);
            const auto value = [](const std::optional<LightSample>& s) {
                return s ? double{std::max(0.0f, s->w_in.v.y)} * s->radiance.g / s->pdf : 0.0;
            };
            difference.push_back(value(lights.sample({0, 0, 0}, point)) * bias
                                 - value(lights.sample({0, 0, 0}, choice, point)));
        }
        return testing::estimate(difference);
    };
    const auto same = estimates(1), biased = estimates(1.02);
    EXPECT_LT(std::abs(same.mean), 5 * same.standard_error);
    EXPECT_GT(std::abs(biased.mean), 5 * biased.standard_error);  // 2 % must be caught
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
