// SPDX-License-Identifier: Apache-2.0
// Light through thin glass: in closed form, in furnaces, and against paths that are followed vertex by
// vertex.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/render_support.hpp"

namespace relumine {
namespace {

using testing::agreement_p;
using testing::block_estimates;
using testing::Estimate;
using testing::mean_of;

using Point = std::array<float, 3>;

constexpr double false_positive_rate = 1e-4;  // of each statistical test below

std::size_t add_quad(SceneBuilder& builder, std::size_t material, Point a, Point b, Point c, Point d) {
    const std::array positions{a, b, c, d};
    const std::array<std::array<std::uint32_t, 3>, 2> triangles{{{0, 1, 2}, {0, 2, 3}}};
    return builder.add_mesh({"", positions, {}, {}, triangles, material});
}

/// Horizontal, facing up.
std::size_t add_plane(SceneBuilder& builder, std::size_t material, float half, float y) {
    return add_quad(builder, material, {-half, y, half}, {half, y, half}, {half, y, -half},
                    {-half, y, -half});
}

std::size_t add_matte(SceneBuilder& builder, float albedo) {
    MaterialDescription matte;
    matte.base_color = {albedo, albedo, albedo};
    matte.specular = 0;
    return builder.add_material(matte);
}

std::size_t add_glass(SceneBuilder& builder, Point tint, float glow = 0) {
    MaterialDescription glass;
    glass.base_color = tint;
    glass.roughness = 0;
    glass.transmission = 1;
    glass.emission = {glow, glow, glow};
    return builder.add_material(glass);
}

/// Looks straight down from a height of ½ m at 1 m².
void look_down(SceneBuilder& builder) {
    CameraDescription camera;
    camera.world_from_camera = {1, 0, 0, 0, 0, 0, -1, 0, 0, 1, 0, 0, 0, 0.5, 0, 1};
    camera.orthographic_height = 1;
    builder.add_camera(camera);
}

RenderSettings small(const std::string& method, int samples, int side = 16) {
    RenderSettings settings;
    settings.method = method;
    settings.samples_per_pixel = samples;
    settings.width = settings.height = side;
    settings.gather_rays = 16;
    return settings;
}

class BehindPanes : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Panes, BehindPanes, ::testing::Values("path", "gather", "reproject", "cache"));

TEST_P(BehindPanes,
       ASunBehindPanesIsDimmedByWhatEachLetsPass) {  // normal incidence: R = 2r / (1 + r), r = .04
    SceneBuilder builder;
    builder.add_instance(add_plane(builder, add_matte(builder, 0.5f), 2, 0));
    const std::size_t green = add_plane(builder, add_glass(builder, {0.25f, 1, 0.5f}), 2, 1);
    builder.add_instance(add_plane(builder, add_glass(builder, {1, 1, 1}), 2, 2));
    builder.add_instance(green);
    builder.add_instance(green,
                         {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 3, 0, 1});  // the same glass, 3 m higher
    builder.add_light(DirectionalLightDescription{{0, -1, 0}, {100, 100, 100}});
    look_down(builder);
    RenderSettings settings = small(GetParam(), 1);
    settings.max_depth = 1;
    const Image image = render(builder.build(), settings);
    const double clear = 1 - 2 * 0.04 / 1.04, unshadowed = 100 * 0.5 / 3.14159265358979;
    for (std::size_t i = 0; i < image.layer()->pixels.size(); i += 3) {
        const float* rgb = &image.layer()->pixels[i];
        for (std::size_t c = 0; c < 3; ++c) {
            const double tint = std::array{0.25, 1.0, 0.5}[c];
            ASSERT_NEAR(rgb[c], unshadowed * std::pow(clear, 3) * tint * tint, 1e-4 * unshadowed) << i;
        }
    }
}

TEST(Panes, LosslessPanesVanishInAFurnace) {
    SceneBuilder builder;
    builder.add_instance(add_plane(builder, add_matte(builder, 1), 50, 0));
    const std::size_t clear = add_glass(builder, {1, 1, 1});
    for (const float y : {0.2f, 0.3f, 0.9f}) builder.add_instance(add_plane(builder, clear, 2, y));
    const std::array<float, 6> white{1, 1, 1, 1, 1, 1};
    builder.set_environment(2, 1, white);
    look_down(builder);
    const Scene scene = builder.build();
    for (const char* method : {"path", "gather"})
        EXPECT_NEAR(mean_of(render(scene, small(method, 64))), 1, 0.002) << method;
}

/// A matte room, its front open but for two panes: a clear one, and one of `tint`. The sky has a bright patch
/// in the solid angle that the opening shows. A glow too faint to see keeps glass from being a pane: its
/// paths are followed vertex by vertex.
Scene glazed_room(Point tint, float glow) {
    SceneBuilder builder;
    const std::size_t matte = add_matte(builder, 0.6f);
    const auto wall = [&](Point a, Point b, Point c, Point d) {
        builder.add_instance(add_quad(builder, matte, a, b, c, d));
    };
    wall({-1, -1, 1}, {1, -1, 1}, {1, -1, -1}, {-1, -1, -1});  // floor
    wall({-1, 1, -1}, {1, 1, -1}, {1, 1, 1}, {-1, 1, 1});      // ceiling
    wall({-1, -1, -1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, -1});  // back
    wall({-1, -1, 1}, {-1, -1, -1}, {-1, 1, -1}, {-1, 1, 1});  // left
    wall({1, -1, -1}, {1, -1, 1}, {1, 1, 1}, {1, 1, -1});      // right
    const auto pane = [&](std::size_t glass, float z) {
        builder.add_instance(add_quad(builder, glass, {-1, -1, z}, {1, -1, z}, {1, 1, z}, {-1, 1, z}));
    };
    pane(add_glass(builder, {1, 1, 1}, glow), 1);
    pane(add_glass(builder, tint, glow), 1.2f);
    std::vector<float> sky(3 * 32 * 16, 0.5f);
    const std::size_t patch = 3 * (5 * 32 + 24);  // towards +z, 29° up
    for (std::size_t i = patch; i < patch + 6; ++i) sky[i] = 60;
    builder.set_environment(32, 16, sky);
    CameraDescription camera;
    camera.world_from_camera = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0.9, 1};
    camera.vertical_fov = 1.4;
    builder.add_camera(camera);
    return builder.build();
}

constexpr Point brown{0.9f, 0.6f, 0.3f};
constexpr float invisible = 1e-12f;

std::vector<Estimate> estimates(const Scene& scene, const RenderSettings& settings, int block) {
    return block_estimates(scene, settings, 12, block);
}

TEST(Panes, StraightShadowsAgreeWithPathsThroughEveryPane) {
    const auto plain = estimates(glazed_room(brown, invisible), small("path", 1024, 24), 24);
    const auto panes = estimates(glazed_room(brown, 0), small("path", 64, 24), 24);
    EXPECT_GT(agreement_p(panes, plain), false_positive_rate);
    EXPECT_LT(agreement_p(panes, plain, 1.02), false_positive_rate);  // a planted bias
}

TEST(Panes, UnbiasedMethodsAgreeThroughColouredPanes) {
    const Scene scene = glazed_room(brown, 0);
    RenderSettings path = small("path", 64, 24);
    path.max_depth = 5;
    const auto reference = estimates(scene, path, 12);
    RenderSettings gather = path;
    gather.method = "gather";
    gather.radiance = "path";
    gather.samples_per_pixel = 8;
    EXPECT_GT(agreement_p(estimates(scene, gather, 12), reference), false_positive_rate);
    gather.light_samples = 4;
    EXPECT_GT(agreement_p(estimates(scene, gather, 12), reference), false_positive_rate) << "light samples";
    RenderSettings cache = path;
    cache.method = "cache";
    cache.unbiased = true;
    cache.samples_per_pixel = 16;
    EXPECT_GT(agreement_p(estimates(scene, cache, 12), reference), false_positive_rate) << "cache";
    EXPECT_LT(agreement_p(reference, reference, 1.02), false_positive_rate);  // a bias that would be caught
}

TEST(Panes, ThreadsDoNotChangeABit) {
    const Scene scene = glazed_room(brown, 0);
    RenderSettings settings = small("path", 4, 40);
    settings.threads = 1;
    const Image one = render(scene, settings);
    settings.threads = 3;
    EXPECT_EQ(one.layer()->pixels, render(scene, settings).layer()->pixels);
}

}  // namespace
}  // namespace relumine
