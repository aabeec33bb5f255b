// SPDX-License-Identifier: Apache-2.0
// The image is a function of scene, settings and seed: not of threads, tiles or crops.
#include <gtest/gtest.h>

#include <algorithm>
#include <ostream>

#include "tests/render_support.hpp"

namespace relumine {
namespace {

using testing::project_scene;

struct Case {
    std::string method, scene, cache_scope = "image";

    bool operator==(const Case&) const = default;
};
std::ostream& operator<<(std::ostream& out, const Case& c) {
    return out << c.method << " " << c.scene << " " << c.cache_scope;
}

bool keeps_records(const Case& c) { return c.method.starts_with("reproject"); }

RenderSettings settings_for(const Case& c) {
    RenderSettings settings;
    settings.method = c.method;
    settings.samples_per_pixel = 3;
    settings.gather_rays = 16;
    settings.record_size = 16;
    settings.cache_scope = c.cache_scope;
    settings.width = 70;
    settings.height = 50;
    settings.aovs = {"albedo", "normal", "depth", "indirect", "variance", "error"};
    if (keeps_records(c)) {  // gap rays are many: only one case follows them further
        settings.max_depth = 3;
        settings.radiance = c == Case{"reproject", "cornell-glossy.glb"} ? "path" : "emission";
        if (c != Case{"reproject", "cornell-glossy.glb", "tile"}) settings.gap_cell = 8;
        if (c.cache_scope == "tile") settings.samples_per_pixel = 2;
        for (const char* layer : {"records", "gaps", "layers", "unknown"}) settings.aovs.emplace_back(layer);
    }
    if (c.method.ends_with("-cache")) {
        settings.glossy_rays = settings.light_samples = 4;
        settings.accuracy = 1;
        settings.max_depth = 2;
        settings.radiance = c.scene == "demo.glb" ? "emission" : "path";
        settings.samples_per_pixel = 2;
        settings.aovs.emplace_back("records");
    }
    if (c.method == "cache") {
        settings.error = 0.05f;
        settings.max_depth = 3;
        if (c.scene == "demo.glb") settings.radiance = "path";  // the other scene has the radiance field
    }
    return settings;
}

Scene scene_of(const Case& c) { return project_scene(c.scene, "sky.exr"); }

/// Every layer of `part`, bit by bit; names the first pixel that differs.
void expect_same_bits(const Image& part, const Image& whole) {
    ASSERT_EQ(part.layers.size(), whole.layers.size());
    for (std::size_t i = 0; i < part.layers.size(); ++i) {
        const Layer &a = part.layers[i], &b = whole.layers[i];
        const std::size_t channels = b.channels.size(), row = static_cast<std::size_t>(part.width) * channels;
        for (int y = 0; y < part.height; ++y) {
            const int whole_y = part.window.y0 + y - whole.window.y0,
                      whole_x = part.window.x0 - whole.window.x0;
            const float* mine = &a.pixels[static_cast<std::size_t>(y) * row];
            const float* theirs =
                &b.pixels[static_cast<std::size_t>(whole_y * whole.width + whole_x) * channels];
            const auto differ = std::mismatch(mine, mine + row, theirs).first - mine;
            ASSERT_EQ(static_cast<std::size_t>(differ), row)
                << "layer \"" << a.name << "\", pixel "
                << part.window.x0 + differ / static_cast<int>(channels) << ", " << part.window.y0 + y << ": "
                << mine[differ] << " and " << theirs[differ];
        }
    }
}

class Determinism : public ::testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(
    Methods, Determinism,
    ::testing::Values(Case{"path", "cornell-glossy.glb"}, Case{"gather", "cornell-glossy.glb"},
                      Case{"path", "demo.glb"}, Case{"reproject", "cornell-glossy.glb"},
                      Case{"reproject", "demo.glb"}, Case{"reproject", "cornell-glossy.glb", "tile"},
                      Case{"reproject", "demo.glb", "tile"}, Case{"reproject-mc", "cornell-glossy.glb"},
                      Case{"reproject-mc", "demo.glb"}, Case{"reproject-mc", "cornell-glossy.glb", "tile"},
                      Case{"reproject-mc", "demo.glb", "tile"}, Case{"cache", "cornell-glossy.glb"},
                      Case{"cache", "demo.glb"}, Case{"irradiance-cache", "cornell-glossy.glb"},
                      Case{"irradiance-cache", "demo.glb"},
                      Case{"radiance-cache", "../tests/pictures/scenes/metals.gltf"}));

TEST_P(Determinism, ThreadsDoNotChangeABit) {
    const Scene scene = scene_of(GetParam());
    RenderSettings settings = settings_for(GetParam());
    settings.threads = 1;
    const Image one = render(scene, settings);
    for (const int threads : {2, 7}) {
        settings.threads = threads;
        SCOPED_TRACE(threads);
        expect_same_bits(render(scene, settings), one);
    }
}

TEST_P(Determinism, ACropHasTheBitsOfTheWhole) {
    const Scene scene = scene_of(GetParam());
    RenderSettings settings = settings_for(GetParam());
    const Image whole = render(scene, settings);
    for (const PixelRect crop : {PixelRect{0, 0, 1, 1}, {13, 7, 47, 41}, {69, 49, 70, 50}}) {
        settings.crop = crop;
        const Image part = render(scene, settings);
        ASSERT_EQ(part.width, crop.width());
        EXPECT_EQ(part.window, crop);
        expect_same_bits(part, whole);
    }
}

TEST_P(Determinism, SeedsMatter) {
    const Scene scene = scene_of(GetParam());
    RenderSettings settings = settings_for(GetParam());
    settings.samples_per_pixel = 1;
    const Image first = render(scene, settings);
    settings.seed = 1;
    EXPECT_NE(first.layer()->pixels, render(scene, settings).layer()->pixels);
}

/// Maps are shared by blocks of cells of 16 pixels, and the filter reaches 14 pixels further: the frame must
/// be longer than that.
TEST(CacheRegion, ACropHasTheBitsOfTheWhole) {
    const Scene scene = scene_of({"cache", "cornell-glossy.glb"});
    RenderSettings settings = settings_for({"cache", "cornell-glossy.glb"});
    settings.radiance = "emission";
    settings.width = 130;
    settings.height = 110;
    for (const int samples : {1, 4})
        for (const bool unbiased : {false, true}) {
            settings.crop = {};
            settings.samples_per_pixel = samples;
            settings.unbiased = unbiased;
            settings.threads = 1;
            const Image whole = render(scene, settings);
            settings.threads = 7;
            expect_same_bits(render(scene, settings), whole);
            for (const PixelRect crop : {PixelRect{64, 48, 65, 49}, {50, 50, 63, 52}, {31, 80, 33, 97}}) {
                settings.crop = crop;
                SCOPED_TRACE(samples);
                expect_same_bits(render(scene, settings), whole);
            }
        }
}

/// Placement reaches 126 pixels and a crop's first sample looks twice as far: the frame must be longer than
/// that.
class PlacementHalo : public ::testing::TestWithParam<std::pair<Case, PixelRect>> {};
INSTANTIATE_TEST_SUITE_P(
    Frames, PlacementHalo,
    ::testing::Values(std::pair{Case{"reproject", "cornell-glossy.glb"}, PixelRect{0, 0, 24, 420}},
                      std::pair{Case{"reproject-mc", "shadow.glb"}, PixelRect{0, 0, 420, 24}},
                      std::pair{Case{"reproject", "demo.glb"}, PixelRect{0, 0, 420, 24}}));

/// Placement reaches 126 pixels and a crop's first sample looks twice as far: the frame must be longer than
/// that.
TEST_P(PlacementHalo, ACropFarFromTheFramesEndHasTheBitsOfTheWhole) {
    const auto& [c, frame] = GetParam();
    const Scene scene = scene_of(c);
    RenderSettings settings = settings_for(c);
    settings.radiance = "emission";
    settings.gap_cell = 8;
    settings.record_spacing = 4;  // pixels, not metres, then limit how far records are used
    settings.records_per_point = 16;
    settings.samples_per_pixel = 2;
    settings.width = frame.width();
    settings.height = frame.height();
    const Image whole = render(scene, settings);
    const int x1 = frame.x1, y1 = frame.y1;
    for (const PixelRect crop : {PixelRect{0, 0, x1 / 20 + 3, y1 / 20 + 3},
                                 {x1 / 3, y1 / 3, x1 / 3 + 5, y1 / 3 + 5},
                                 {x1 - 9, y1 - 9, x1, y1}}) {
        settings.crop = crop;
        expect_same_bits(render(scene, settings), whole);
    }
}

TEST(Layers, SplitAddsUpToThePicture) {
    RenderSettings settings = settings_for({"path", "cornell-glossy.glb"});
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
