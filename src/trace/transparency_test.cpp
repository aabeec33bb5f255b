// SPDX-License-Identifier: Apache-2.0
// Panes: what passes is a product, whatever its order; what is met and what is passed add up.
#include "trace/transparency.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "base/hash.hpp"

namespace relumine {
namespace {

TEST(PassedLight, IsTheProductInAnyOrder) {
    std::vector<Spectrum> shares;
    Spectrum product{1};
    for (std::uint32_t i = 0; i < 20; ++i) {
        const auto number = [&](std::uint64_t c) {
            return unit_float(static_cast<std::uint32_t>(hash(i, c)));
        };
        shares.push_back({0.5f + 0.5f * number(1), 0.5f + 0.5f * number(2), 1});
        product *= shares.back();
    }
    PassedLight forwards, backwards;
    for (const Spectrum share : shares) forwards.multiply(3, share);
    std::ranges::reverse(shares);
    for (const Spectrum share : shares) backwards.multiply(3, share);
    EXPECT_EQ(forwards[3], backwards[3]);
    EXPECT_NEAR(forwards[3].r, product.r, 1e-6f * product.r);
    EXPECT_NEAR(forwards[3].g, product.g, 1e-6f * product.g);
    EXPECT_EQ(forwards[3].b, 1);
    EXPECT_EQ(forwards[0], Spectrum{1});
    forwards.multiply(3, {0, 1, 1});
    EXPECT_EQ(forwards[3].r, 0);
}

/// `instances` squares of 2 m, one above the other 1 m apart from y = 1 on, over a floor at y = 0.
SceneData stack(int instances) {
    SceneData scene;
    scene.materials.resize(2);
    Mesh square;
    square.positions = {{-1, 0, -1}, {1, 0, -1}, {1, 0, 1}, {-1, 0, 1}};
    square.triangles = {{{0, 1, 2}}, {{0, 2, 3}}};
    scene.meshes = {square, square};
    scene.meshes[1].material = MaterialId{1};
    scene.instances.resize(1);
    scene.instances[0].identity = true;
    for (int i = 0; i < instances; ++i) {
        Instance instance;
        instance.mesh = MeshId{1};
        instance.world_from_object.m[1][3] = 1 + i;
        scene.instances.push_back(instance);
    }
    return scene;
}

constexpr Spectrum passed{0.8f, 0.5f, 0.25f};

PaneModel panes(const SceneData& scene) {
    return {[&scene](const Mesh& mesh) { return &mesh == &scene.meshes[1] ? Pane::coloured : Pane::none; },
            [](const Hit&, WorldDir) { return passed; }};
}

TEST(Panes, TakeTheirShareOfAShadowRay) {
    for (const int count : {1, 3}) {
        const SceneData scene = stack(count);
        const Tracer tracer(scene, {}, panes(scene));
        const Ray ray{{0.3f, 0.1f, 0.2f}, {{0, 1, 0}}};
        EXPECT_FALSE(tracer.occluded(ray));
        const Spectrum light = tracer.passed_light(ray);
        EXPECT_NEAR(light.r, std::pow(0.8, count), 1e-6);
        EXPECT_NEAR(light.b, std::pow(0.25, count), 1e-6);
        EXPECT_TRUE(is_black(tracer.passed_light({{0.3f, 0.1f, 0.2f}, {{0, -1, 0}}})));  // the floor
        std::array<Ray, packet_size> rays;
        rays.fill(ray);
        rays[5].direction = {{0, -1, 0}};
        rays[7].t_max = 1.5f;
        std::array<Spectrum, packet_size> shares;
        tracer.passed_light(rays, shares);
        EXPECT_EQ(shares[0], light);
        EXPECT_TRUE(is_black(shares[5]));
        EXPECT_NEAR(shares[7].r, 0.8, 1e-6);
    }
}

TEST(Panes, WhatRaysBringThroughThemHasTheirColour) {  // over many rays: the panes' transmittances
    const SceneData scene = stack(2);
    const Tracer tracer(scene, {}, panes(scene));
    Ray ray{{0.3f, 3.5f, 0.2f}, {{0, -1, 0}}};
    Spectrum light;
    int met = 0;
    constexpr int rays = 20'000;
    for (std::uint32_t seed = 0; seed < rays; ++seed) {
        ray.opacity_seed = static_cast<std::uint32_t>(mix(seed));
        const Hit hit = tracer.closest_hit(ray);
        ASSERT_TRUE(hit);
        met += hit.instance != 0 ? 1 : 0;
        if (hit.instance == 0) light += tracer.tint(ray, hit.t);
        ASSERT_TRUE(hit.instance != 2 || tracer.tint(ray, hit.t) == Spectrum{1});  // the first that it meets
    }
    EXPECT_NEAR(met, (1 - 0.64) * rays, 5 * std::sqrt(0.64 * 0.36 * rays));
    for (const auto& [found, one] : {std::pair{light.r, 0.8}, {light.g, 0.5}, {light.b, 0.25}})
        EXPECT_NEAR(found / rays, one * one, 5 * one * one / 0.64 * std::sqrt(0.64 * 0.36 / rays));
}

}  // namespace
}  // namespace relumine
