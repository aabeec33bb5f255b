// SPDX-License-Identifier: Apache-2.0
// The rival caches as methods: furnaces, agreement with `path`, what they report.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/render_support.hpp"

namespace relumine {
namespace {

using testing::block_means;
using testing::project_scene;

RenderSettings small(const std::string& method) {
    RenderSettings settings;
    settings.method = method;
    settings.samples_per_pixel = 1;
    settings.pixel_sampling = "center";
    settings.width = settings.height = 36;
    settings.record_size = 32;
    settings.radiance = "path";
    return settings;
}

/// The greatest relative difference of any block's mean; `scale` multiplies the second (to plant a bias).
double worst_block(const Image& a, const Image& b, int side, double scale = 1) {
    const std::vector<double> mine = block_means(a, side), theirs = block_means(b, side);
    double worst = 0;
    for (std::size_t i = 0; i < mine.size(); ++i)
        worst = std::max(worst, std::abs(mine[i] / (scale * theirs[i]) - 1));
    return worst;
}

class Rival : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Methods, Rival, ::testing::Values("irradiance-cache", "radiance-cache"));

TEST_P(Rival, AWhiteBodyVanishesInAWhiteSky) {  // no noise: every ray finds the same
    const Image image = render(project_scene("furnace-diffuse.glb", "white.pfm"), small(GetParam()));
    for (const float pixel : image.layer()->pixels) ASSERT_NEAR(pixel, 1, 1e-4f);
}

TEST_P(Rival, LosslessGlassShowsWhatRecordsHoldBehindIt) {
    RenderSettings settings = small(GetParam());
    settings.samples_per_pixel = 16;
    const Image image = render(project_scene("furnace-glass.glb", "white.pfm"), settings);
    EXPECT_NEAR(testing::mean_of(image), 1, 0.002);
}

/// Means over blocks of 12 × 12 pixels within 4 %, of the whole picture within 1 %: records of 32² paths have
/// a relative standard error of about 2 %, and blocks hold many records.
TEST_P(Rival, AgreesWithPathsInABox) {
    const Scene scene = project_scene("cornell-glossy.glb");
    RenderSettings settings = small(GetParam());
    settings.light_samples = settings.glossy_rays = 100;
    settings.max_depth = 4;
    const Image image = render(scene, settings);
    settings.method = "path";
    settings.samples_per_pixel = 512;
    const Image reference = render(scene, settings);
    EXPECT_LT(worst_block(image, reference, 36), 0.01);
    EXPECT_GT(worst_block(image, reference, 36, 1.02), 0.01);
    EXPECT_LT(worst_block(image, reference, 12), 0.04);
    EXPECT_GT(worst_block(image, reference, 12, 1.05), 0.04);
}

/// An open scene under a sky: what the records hold is straight from light, in the layer `direct`.
TEST_P(Rival, AgreesWithPathsUnderASky) {
    const Scene scene = project_scene("validation/open.glb", "validation/sky.pfm");
    RenderSettings settings = small(GetParam());
    settings.light_samples = settings.glossy_rays = 100;
    settings.max_depth = 1;
    const Image image = render(scene, settings);
    settings.method = "path";
    settings.samples_per_pixel = 512;
    const Image reference = render(scene, settings);
    EXPECT_LT(worst_block(image, reference, 36), 0.01);
    EXPECT_LT(worst_block(image, reference, 12), 0.04);
}

constexpr const char* metals = "../tests/pictures/scenes/metals.gltf";

/// A mirror, a sharp lobe and a broad one on matte ground.
TEST_P(Rival, AgreesWithPathsOnMetals) {
    const Scene scene = project_scene(metals, "validation/sky.pfm");
    RenderSettings settings = small(GetParam());
    settings.light_samples = settings.glossy_rays = 100;
    settings.max_depth = 2;
    const Image image = render(scene, settings);
    settings.method = "path";
    settings.samples_per_pixel = 512;
    const Image reference = render(scene, settings);
    EXPECT_LT(worst_block(image, reference, 36), 0.01);
    EXPECT_LT(worst_block(image, reference, 12), 0.03);
    EXPECT_GT(worst_block(image, reference, 12, 1.04), 0.03);
}

class Listener : public RenderObserver {
  public:
    void finished(const RenderStats& s) override { stats = s; }
    RenderStats stats;
};

TEST_P(Rival, ReportsRecordsAndTheirRays) {
    RenderSettings settings = small(GetParam());
    settings.max_depth = 1;
    settings.aovs = {"records"};
    Listener listener;
    const Image image = render(project_scene("cornell-glossy.glb"), settings, &listener);
    ASSERT_TRUE(listener.stats.cache);
    EXPECT_GT(listener.stats.cache->records, 50u);
    EXPECT_GT(listener.stats.cache->points, 900u);
    EXPECT_GT(listener.stats.rays.at("record"), 800 * listener.stats.cache->records);
    EXPECT_GT(testing::mean_of(image), 0);
    EXPECT_GE(std::ranges::max(image.layer("records")->pixels), 2);
}

TEST(RadianceCacheMethod, HoldsBroadLobesInRecordsAndTracesTheSharpOnes) {
    const Scene scene = project_scene(metals, "validation/sky.pfm");
    RenderSettings settings = small("irradiance-cache");
    settings.max_depth = 1;
    Listener diffuse, broad;
    (void)render(scene, settings, &diffuse);
    settings.method = "radiance-cache";
    (void)render(scene, settings, &broad);
    EXPECT_GT(broad.stats.cache->records, diffuse.stats.cache->records + 5);
    EXPECT_LT(broad.stats.rays.at("gather"), diffuse.stats.rays.at("gather"));
    EXPECT_GT(broad.stats.rays.at("gather"), 0u);
}

TEST_P(Rival, LessErrorTakesMoreRecords) {
    RenderSettings settings = small(GetParam());
    settings.max_depth = 1;
    std::uint64_t before = 0;
    for (const float accuracy : {0.8f, 0.4f, 0.1f}) {
        settings.accuracy = accuracy;
        Listener listener;
        (void)render(project_scene("cornell-glossy.glb"), settings, &listener);
        EXPECT_GT(listener.stats.cache->records, before);
        before = listener.stats.cache->records;
    }
}

}  // namespace
}  // namespace relumine
