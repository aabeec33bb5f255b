// SPDX-License-Identifier: Apache-2.0
// Every method on several threads at once, kept and watched meanwhile: what ThreadSanitizer looks at in
// little time. The pictures are those of one thread.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/keep_support.hpp"
#include "tests/run_command.hpp"

namespace relumine {
namespace {

struct Case {
    const char* method;
    const char* radiance = "emission";
    const char* scope = "image";
};

void PrintTo(const Case& c, std::ostream* out) { *out << c.method << ' ' << c.radiance << ' ' << c.scope; }

/// Looks at everything that it is told, as a progress bar does.
struct Watcher : RenderObserver {
    std::uint64_t rays = 0, tiles = 0;
    void progress(const Progress& p) override { rays = p.rays; }
    void tile_finished(const PixelRect&) override { ++tiles; }
};

class ManyThreads : public ::testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(Methods, ManyThreads,
                         ::testing::Values(Case{"path"}, Case{"gather"}, Case{"reproject"},
                                           Case{"reproject", "direct", "tile"}, Case{"reproject-mc"},
                                           Case{"cache"}, Case{"block-gather", "path"},
                                           Case{"irradiance-cache"}, Case{"radiance-cache"}));
INSTANTIATE_TEST_SUITE_P(Fields, ManyThreads,
                         ::testing::Values(Case{"gather", "radiosity"}, Case{"cache", "radiosity"}));

TEST_P(ManyThreads, GiveThePictureOfOne) {
    const Scene scene = testing::project_scene("cornell-glossy.glb", "sky.exr");
    const test::ScratchFolder folder;
    RenderSettings settings = testing::small_settings(GetParam().method);
    settings.radiance = GetParam().radiance;
    settings.cache_scope = GetParam().scope;
    settings.samples_per_pixel = 1;
    settings.width = 80;  // more than one tile, of either kind
    settings.height = 24;
    RenderControl control;
    control.checkpoint = folder / "a.ckpt";
    control.checkpoint_interval = 0;
    settings.threads = 4;
    Watcher watcher;
    const Image many = render(scene, settings, control, &watcher);
    EXPECT_GT(watcher.rays, 0u);
    EXPECT_GT(watcher.tiles, 1u);
    settings.threads = 1;
    EXPECT_EQ(many.layers[0].pixels, render(scene, settings).layers[0].pixels);
}

}  // namespace
}  // namespace relumine
