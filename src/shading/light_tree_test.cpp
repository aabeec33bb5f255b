// SPDX-License-Identifier: Apache-2.0
// Light trees: what they draw follows their probabilities, what they never draw does not shine, and the light
// that they find is what drawing by power finds.
#include "shading/light_tree.hpp"

#include <gtest/gtest.h>

#include <numeric>
#include <set>

#include "base/sample_stream.hpp"
#include "shading/light_sampler.hpp"
#include "tests/statistics.hpp"

namespace relumine {
namespace {

struct Numbers {
    float a, b, c;
};
Numbers numbers(std::uint32_t i, std::uint64_t key = 5) {
    const SampleStream stream{key, i, 1, PointSet::independent};
    const auto [x, y] = stream.next2(Dim::light_point);
    return {stream.next1(Dim::light_choice), x, y};
}
Vec3 place(std::uint32_t i, float scale) {
    const auto [a, b, c] = numbers(i, 17);
    return Vec3{2 * a - 1, 2 * b - 1, 2 * c - 1} * scale;
}

/// Small triangles about the origin within `scale`, facing all ways; every seventh shines on both sides.
SceneData sparks(std::uint32_t count, float scale = 2) {
    SceneData scene;
    for (std::uint32_t i = 0; i < count; ++i) {
        Material light;
        light.emission = Spectrum{1 + 20 * numbers(i, 3).a};
        light.double_sided = i % 7 == 0;
        Mesh mesh;
        mesh.material = MaterialId{i};
        const Vec3 center = place(i, scale);
        for (std::uint32_t corner = 0; corner < 3; ++corner)
            mesh.positions.push_back(center + place(1000 * (corner + 1) + i, 0.1f));
        mesh.triangles = {{{0, 1, 2}}};
        for (const Vec3 p : mesh.positions) scene.bounds.add(p);
        Instance instance;
        instance.mesh = MeshId{i};
        instance.identity = true;
        scene.materials.push_back(light);
        scene.meshes.push_back(std::move(mesh));
        scene.instances.push_back(instance);
    }
    return scene;
}

std::vector<LightBounds> lamps(std::uint32_t count) {
    std::vector<LightBounds> lights(count);
    for (std::uint32_t i = 0; i < count; ++i) {
        lights[i].box.add(place(i, 2));
        lights[i].box.add(place(i, 2) + place(3000 + i, 0.1f));
        lights[i].normals = {normalize(place(6000 + i, 1)), 0};
        lights[i].spread = 0.5f * pi;
        lights[i].intensity = i % 5 == 4 ? 0.0f : 0.1f + numbers(i).a;
    }
    return lights;
}

/// The probabilities of all lights seen from `from`.
std::vector<double> probabilities(const LightTree& tree, std::uint32_t count, Vec3 from) {
    std::vector<double> p(count);
    for (std::uint32_t i = 0; i < count; ++i) p[i] = tree.probability(from, i);
    return p;
}

TEST(LightTree, ProbabilitiesAddUpToOneWhereLightsShineAllWays) {
    auto lights = lamps(200);
    for (LightBounds& light : lights) light.two_sided = true;
    const LightTree tree(lights);
    for (std::uint32_t i = 0; i < 20; ++i) {
        double sum = 0;
        for (const double p : probabilities(tree, 200, place(100 + i, 3))) sum += p;
        EXPECT_NEAR(sum, 1, 1e-5);
    }
    EXPECT_EQ(tree.probability({}, 4), 0);  // has no intensity
}

TEST(LightTree, DrawsFollowProbabilities) {  // χ², 200 lights, α = 1e-6
    const auto lights = lamps(200);
    const LightTree tree(lights);
    constexpr int draws = 100'000;
    const Vec3 from{0.2f, 0.1f, -0.3f};
    std::vector<double> observed(201), expected = probabilities(tree, 200, from);
    std::vector<double> mutant = probabilities(tree, 200, from + Vec3{0.05f, 0, 0});  // of a place 5 cm away
    for (std::vector<double>* p : {&expected, &mutant})
        p->push_back(1 - std::accumulate(p->begin(), p->end(), 0.0));
    for (std::uint32_t i = 0; i < draws; ++i) {
        const auto drawn = tree.sample(from, numbers(i).a);
        if (!drawn) ++observed[200];  // a group that might shine here, of lights that do not
        if (!drawn) continue;
        ASSERT_NEAR(drawn->probability, expected[drawn->light], 1e-5 * expected[drawn->light]);
        ASSERT_TRUE(drawn->u >= 0 && drawn->u < 1);
        ++observed[drawn->light];
    }
    for (double& p : expected) p *= draws;
    for (double& p : mutant) p *= draws;
    EXPECT_GT(testing::chi_square_p(observed, expected), 1e-6);
    EXPECT_LT(testing::chi_square_p(observed, mutant), 1e-6);
}

TEST(LightTree, OneLightIsAlwaysDrawn) {
    auto lights = lamps(1);
    lights[0].two_sided = true;
    const LightTree tree(lights);
    EXPECT_EQ(tree.sample({1, 2, 3}, 0.25f)->probability, 1);
    EXPECT_NEAR(tree.sample({1, 2, 3}, 0.25f)->u, 0.25f, 1e-6f);
    EXPECT_EQ(tree.probability({1, 2, 3}, 0), 1);
}

TEST(LightTree, LightsInTheSamePlaceAreTold) {
    std::vector<LightBounds> lights = lamps(1);
    lights.resize(5000, lights[0]);
    const LightTree tree(lights);
    std::set<std::uint32_t> drawn;
    for (std::uint32_t i = 0; i < 50'000; ++i)
        drawn.insert(tree.sample(lights[0].box.center(), numbers(i).a)->light);
    EXPECT_GT(drawn.size(), 4900u);
}

TEST(Cone, HoldsWhatItUnites) {
    for (std::uint32_t i = 0; i < 200; ++i) {
        const Cone a{normalize(place(i, 1)), numbers(i).a}, b{normalize(place(500 + i, 1)), 2 * numbers(i).b};
        const Cone both = unite(a, b);
        for (const Cone& part : {a, b})
            EXPECT_GE(
                both.angle + 1e-3f,
                std::min(pi, std::acos(std::clamp(dot(both.axis, part.axis), -1.0f, 1.0f)) + part.angle));
    }
}

double brightness(const std::optional<LightSample>& s) {
    return s ? double{std::max(0.0f, s->w_in.v.y)} * s->radiance.g / s->pdf : 0.0;
}

constexpr int draws = 100'000;

testing::Estimate irradiance(const LightSampler& lights, Vec3 from, double bias = 1) {
    std::vector<double> values;
    for (std::uint32_t i = 0; i < draws; ++i) {
        const auto [choice, x, y] = numbers(i, 23);
        values.push_back(
            bias
            * brightness(i % 2 == 0 ? lights.sample(from, choice, {x, y}) : lights.sample(from, {x, y})));
    }
    return testing::estimate(values);
}

TEST(LightTree, FindsTheLightThatPowerFindsWithLessNoise) {  // z-tests of 5σ each
    SceneData scene = sparks(300);
    scene.point_lights.push_back({{0, 1, 0}, Spectrum{0.2f}});
    scene.spot_lights.push_back({{0, 3, 0}, {0, -1, 0}, Spectrum{2}, 0.95f, 0.8f});
    scene.directional_lights.push_back({{0, -1, 0}, Spectrum{0.1f}});
    scene.directional_lights.push_back({{0.6f, -0.8f, 0}, Spectrum{0.05f}});
    LightSelection by_power;
    by_power.tree_from = 1'000'000;
    const LightSampler power(scene, by_power), tree(scene, {});
    double of_power = 0, of_tree = 0;
    for (std::uint32_t i = 0; i < 4; ++i) {
        const Vec3 from = place(70 + i, 1.5f);
        const auto a = irradiance(power, from), b = irradiance(tree, from);
        const double error = std::hypot(a.standard_error, b.standard_error);
        EXPECT_LT(std::abs(a.mean - b.mean), 5 * error) << i;
        of_power += std::pow(a.standard_error / a.mean, 2);
        of_tree += std::pow(b.standard_error / b.mean, 2);
    }
    EXPECT_LT(of_tree, 0.7 * of_power);
    const Vec3 from = place(70, 1.5f);
    const auto a = irradiance(tree, from), b = irradiance(tree, from, 1.1);
    EXPECT_GT(b.mean - a.mean, 5 * a.standard_error);  // a bias of 10 % would be seen
}

TEST(LightTree, PdfOfAHitIsThatOfTheSample) {
    const SceneData scene = sparks(300);
    const LightSampler lights(scene, {});
    int compared = 0;
    for (std::uint32_t i = 0; i < 500; ++i) {
        const Vec3 from = place(i, 2);
        const auto [choice, x, y] = numbers(i);
        const auto s = lights.sample(from, choice, {x, y});
        if (!s) continue;
        for (std::uint32_t light = 0; light < 300;
             ++light) {  // the one that was drawn has the sample's point
            const auto& p = scene.meshes[light].positions;
            const Vec3 point = from + s->w_in.v * s->distance, n = normalize(cross(p[1] - p[0], p[2] - p[0]));
            if (length(point - (p[0] + p[1] + p[2]) * (1 / 3.0f)) > 0.2f
                || std::abs(dot(point - p[0], n)) > 1e-5f)
                continue;
            SurfacePoint hit;
            hit.position = point;
            hit.instance = light;
            EXPECT_NEAR(lights.pdf(from, hit) / s->pdf, 1, 2e-2);
            ++compared;
        }
    }
    EXPECT_GT(compared, 150);
}

}  // namespace
}  // namespace relumine
