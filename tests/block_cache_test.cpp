// SPDX-License-Identifier: Apache-2.0
// `cache`: unbiased where asked to be, else as close to `gather` as its error says; right in furnaces.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/cache_support.hpp"

namespace relumine {
namespace {

using testing::agreement_p;
using testing::block_means;
using testing::Estimate;
using testing::mean_of;
using testing::project_scene;
using testing::welch_p;

class CacheScenes : public ::testing::TestWithParam<std::size_t> {
  protected:
    const Case& scene_case = cases[GetParam()];
    const Scene scene = project_scene(scene_case.scene, scene_case.environment);
};
INSTANTIATE_TEST_SUITE_P(Scenes, CacheScenes, ::testing::Range(std::size_t{0}, cases.size()),
                         [](const auto& c) { return cases[c.param].name; });

/// Block means: Welch, 9 blocks, Šidák. The picture's mean: Welch; a planted bias of 1 % must be caught.
TEST_P(CacheScenes, UnbiasedItIsGather) {
    const Pictures reference = render_seeds(scene, gathered(scene_case), 16);
    const Pictures cached = render_seeds(scene, unbiased(scene_case), 24);
    const Estimate mean = whole(cached), expected = whole(reference);
    EXPECT_GT(agreement_p(blocks(cached), blocks(reference)), false_positive_rate);
    EXPECT_GT(welch_p(mean, expected), false_positive_rate) << mean.mean << " " << expected.mean;
    EXPECT_LT(std::hypot(mean.standard_error, expected.standard_error), 0.0018 * expected.mean);
    for (const double scale : {0.99, 1.01})
        EXPECT_LT(welch_p({scale * mean.mean, scale * mean.standard_error, mean.count}, expected),
                  false_positive_rate)
            << scale;
}

/// Σ|a − b| / Σ b over all channels.
double difference(const Image& a, const Image& b) {
    double sum = 0, all = 0;
    for (std::size_t i = 0; i < b.layer()->pixels.size(); ++i) {
        sum += std::abs(a.layer()->pixels[i] - b.layer()->pixels[i]);
        all += b.layer()->pixels[i];
    }
    return sum / all;
}

/// Numbers of rays that follow from what other pixels' rays have found leave the mean as it is: a glossy room
/// where a second series is asked for. Joined by anything else than rays, series show; so does 1 %.
TEST(CacheOfGlossyRooms, RaysByDemandAreUnbiased) {
    const Case& room = cases[0];
    RenderSettings by_demand = unbiased(room);
    by_demand.residual_rays = by_demand.light_samples = -1;
    by_demand.error = 0.05f;
    const Scene scene = project_scene(room.scene);
    const Estimate expected = whole(render_seeds(scene, gathered(room), 10)),
                   mean = whole(render_seeds(scene, by_demand, 48));
    EXPECT_GT(welch_p(mean, expected), false_positive_rate) << mean.mean << " " << expected.mean;
    for (const double scale : {0.99, 1.01})
        EXPECT_LT(welch_p({scale * mean.mean, scale * mean.standard_error, mean.count}, expected),
                  false_positive_rate)
            << scale;
}

TEST_P(CacheScenes, ComesCloserToGatherTheLessErrorIsAllowed) {
    RenderSettings reference = gathered(scene_case), settings = settings_for(scene_case, "cache");
    for (RenderSettings* s : {&reference, &settings}) {
        s->width = s->height = 40;
        s->radiance = "emission";
    }
    reference.gather_rays = 8192;
    reference.light_samples = 2048;
    const Image expected = render(scene, reference);
    settings.error = 0.04f;
    const double coarse = difference(render(scene, settings), expected);
    settings.error = 0.005f;
    const double fine = difference(render(scene, settings), expected);
    EXPECT_LT(fine, coarse);
    EXPECT_LT(coarse, 0.1);
    settings.filter_residual =
        false;  // it blurs what is smaller than a few pixels: small pictures are full of that
    settings.residual_rays = settings.light_samples = 256;
    const double sampled = difference(render(scene, settings), expected);
    EXPECT_LT(sampled, 0.015);
    if (GetParam() == 0) {  // of large surfaces
        EXPECT_LT(fine, 0.015);
    }
}

TEST(Cache, EveryPartLeftOutShowsAndIsRightStill) {
    const Case& sunny = cases[1];
    const Scene scene = project_scene(sunny.scene, sunny.environment);
    RenderSettings settings = settings_for(sunny, "cache");
    settings.width = settings.height = 40;
    const Image whole = render(scene, settings);
    for (const char* part : {"reprojection", "splits", "blending"}) {
        settings.without = {part};
        const double changed = difference(render(scene, settings), whole);
        EXPECT_GT(changed, 0) << part;
        EXPECT_LT(changed, 0.1) << part;
    }
}

RenderSettings small(const std::string& method, int samples) {
    RenderSettings settings;
    settings.method = method;
    settings.samples_per_pixel = samples;
    settings.width = settings.height = 32;
    settings.light_samples = 128;
    settings.residual_rays = 64;
    return settings;
}

class CacheMethods : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Methods, CacheMethods, ::testing::Values("cache", "block-gather"));

TEST_P(CacheMethods, ClosedFurnaceIsOne) {
    std::vector<const char*> names{"furnace-walls-50.glb"};
    // Without residual rays nothing but light samples sees emitters in corners: too noisy for bright walls.
    if (std::string(GetParam()) == "cache") names.push_back("furnace-walls-80.glb");
    for (const char* name : names)
        EXPECT_NEAR(mean_of(render(project_scene(name), small(GetParam(), 8))), 1, 0.003) << name;
}

TEST_P(CacheMethods, FurnaceOfLimitedDepthIsItsPartialSum) {  // emission .5, albedo .5: ½ + ¼ + …
    RenderSettings settings = small(GetParam(), 8);
    for (int depth = 0; depth < 4; ++depth) {
        settings.max_depth = depth;
        EXPECT_NEAR(mean_of(render(project_scene("furnace-walls-50.glb"), settings)),
                    1 - std::pow(0.5, depth + 1), 0.003)
            << depth;
    }
}

TEST_P(CacheMethods, WhiteBodiesVanishInAWhiteSky) {
    const Image image = render(project_scene("furnace-diffuse.glb", "white.pfm"), small(GetParam(), 4));
    EXPECT_NEAR(mean_of(image), 1, 0.003);
    for (const float pixel : image.layer()->pixels) ASSERT_NEAR(pixel, 1, 0.1f);
}

TEST_P(CacheMethods, MetalLosesWhatSingleScatteringLoses) {  // scenes/README.md
    EXPECT_NEAR(mean_of(render(project_scene("furnace-metal.glb", "white.pfm"), small(GetParam(), 4))), 0.987,
                0.003);
}

TEST_P(CacheMethods, GreySphereIsOne) {  // a point light, and what it makes of the walls
    EXPECT_NEAR(mean_of(render(project_scene("grey-sphere.glb"), small(GetParam(), 8))), 1, 0.005);
}

TEST_P(CacheMethods, GlassIsLeftToPaths) {
    for (const char* name : {"furnace-glass.glb", "furnace-rough-glass.glb"}) {
        const Image image = render(project_scene(name, "white.pfm"), small(GetParam(), 4));
        for (const float pixel : image.layer()->pixels) {
            ASSERT_TRUE(std::isfinite(pixel));
            ASSERT_GE(pixel, 0);
        }
        EXPECT_NEAR(mean_of(image), 0.985, 0.025) << name;
    }
}

/// No map knows what rough glass lets through: rays for it must follow the wanted error as others do, not the
/// thousands of `gather` for every camera sample (which took minutes for a picture like this).
TEST_P(CacheMethods, RoughGlassTakesNoMoreRaysThanTheErrorAsksFor) {
    class Listener : public RenderObserver {
      public:
        void finished(const RenderStats& s) override { stats = s; }
        RenderStats stats;
    };
    RenderSettings settings;
    settings.method = GetParam();
    settings.width = settings.height = 16;
    const auto rays_per_pixel = [&](float error, int samples) {
        settings.error = error;
        settings.samples_per_pixel = samples;
        Listener listener;
        (void)render(project_scene("furnace-rough-glass.glb", "white.pfm"), settings, &listener);
        return static_cast<double>(listener.stats.rays.at("gather")) / (16 * 16);
    };
    const double usual = rays_per_pixel(0.02f, 16);
    EXPECT_GT(usual, 100);
    EXPECT_LE(usual, 512);
    EXPECT_LT(rays_per_pixel(0.05f, 16), usual / 2);
    EXPECT_NEAR(rays_per_pixel(0.02f, 64) / usual, 1, 0.05);
}

TEST_P(CacheMethods, EveryPixelIsFinite) {  // textures, glass, mirrors, a sun
    const Image image = render(project_scene("demo.glb", "sky.exr"), small(GetParam(), 2));
    for (const float pixel : image.layer()->pixels) ASSERT_TRUE(std::isfinite(pixel));
    EXPECT_GT(mean_of(image), 0);
}

}  // namespace
}  // namespace relumine
