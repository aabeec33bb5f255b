// SPDX-License-Identifier: Apache-2.0
// The image is a function of scene, settings and seed: not of threads, tiles or crops.
#include <gtest/gtest.h>

#include "tests/render_support.hpp"

namespace relumine {
namespace {

using testing::project_scene;

RenderSettings settings_for(const std::string& method) {
    RenderSettings settings;
    settings.method = method;
    settings.samples_per_pixel = 3;
    settings.gather_rays = 16;
    settings.width = 70;
    settings.height = 50;
    settings.aovs = {"albedo", "normal", "depth", "indirect", "variance"};
    return settings;
}

class Determinism : public ::testing::TestWithParam<std::pair<const char*, const char*>> {};
INSTANTIATE_TEST_SUITE_P(Methods, Determinism,
                         ::testing::Values(std::pair{"path", "cornell-glossy.glb"},
                                           std::pair{"gather", "cornell-glossy.glb"},
                                           std::pair{"path", "demo.glb"}));

TEST_P(Determinism, ThreadsDoNotChangeABit) {
    const auto [method, name] = GetParam();
    const Scene scene = project_scene(name, "sky.exr");
    RenderSettings settings = settings_for(method);
    settings.threads = 1;
    const Image one = render(scene, settings);
    for (const int threads : {2, 7}) {
        settings.threads = threads;
        const Image many = render(scene, settings);
        for (std::size_t i = 0; i < one.layers.size(); ++i)
            EXPECT_EQ(one.layers[i].pixels, many.layers[i].pixels) << one.layers[i].name;
    }
}

TEST_P(Determinism, ACropHasTheBitsOfTheWhole) {
    const auto [method, name] = GetParam();
    const Scene scene = project_scene(name, "sky.exr");
    RenderSettings settings = settings_for(method);
    const Image whole = render(scene, settings);
    for (const PixelRect crop : {PixelRect{0, 0, 1, 1}, {13, 7, 47, 41}, {69, 49, 70, 50}}) {
        settings.crop = crop;
        const Image part = render(scene, settings);
        ASSERT_EQ(part.width, crop.width());
        EXPECT_EQ(part.window, crop);
        for (int y = crop.y0; y < crop.y1; ++y)
            for (int x = crop.x0; x < crop.x1; ++x)
                ASSERT_EQ(part.rgb(x - crop.x0, y - crop.y0), whole.rgb(x, y)) << x << " " << y;
    }
}

TEST_P(Determinism, SeedsMatter) {
    const auto [method, name] = GetParam();
    const Scene scene = project_scene(name, "sky.exr");
    RenderSettings settings = settings_for(method);
    const Image first = render(scene, settings);
    settings.seed = 1;
    EXPECT_NE(first.layer()->pixels, render(scene, settings).layer()->pixels);
}

TEST(Layers, SplitAddsUpToThePicture) {
    RenderSettings settings = settings_for("path");
    settings.aovs = {"emission", "direct", "indirect", "samples"};
    const Image image = render(project_scene("cornell-glossy.glb"), settings);
    for (std::size_t i = 0; i < image.layer()->pixels.size(); ++i) {
        const float sum = image.layer("emission")->pixels[i] + image.layer("direct")->pixels[i]
                          + image.layer("indirect")->pixels[i];
        ASSERT_NEAR(sum, image.layer()->pixels[i], 1e-5f * sum + 1e-6f);
    }
    for (const float n : image.layer("samples")->pixels) EXPECT_EQ(n, 3);
}

}  // namespace
}  // namespace relumine
