// SPDX-License-Identifier: Apache-2.0
// Methods whose records or maps do not fit in the memory that they are given: fewer are kept, on any number
// of threads the same, and the picture is still right.
#include "base/memory.hpp"

#include <gtest/gtest.h>

#include "integrators/registry.hpp"
#include "render_setup.hpp"
#include "tests/render_support.hpp"

namespace relumine {
namespace {

using testing::project_scene;

struct Case {
    const char *name, *method, *scope;
    std::uint64_t little;  // bytes that show, yet suffice for some
};
void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

RenderSettings settings_for(const Case& c) {
    RenderSettings settings;
    settings.method = c.method;
    settings.cache_scope = c.scope;
    settings.samples_per_pixel = 2;
    settings.width = settings.height = 36;
    settings.gather_rays = 64;
    settings.record_size = 16;
    settings.gap_cell = 8;
    settings.radiance = "emission";
    settings.error = 0.005f;  // small blocks
    return settings;
}

struct Rendered {
    std::vector<float> pixels;  // radiance of the samples of both passes, or of one
    CacheCounts counts;
    double sum = 0;
};

/// All samples as the passes of a render have them, with `bytes` for what grows.
Rendered rendered(const Case& c, std::uint64_t bytes, int threads) {
    const Scene scene = project_scene("cornell-glossy.glb");
    const RenderSettings settings = settings_for(c);
    RenderSetup setup(scene.data(), settings, find_framing(scene.data(), settings), [](const char*) {});
    const auto integrator = make_integrator(settings, setup.transport, setup.view, false);
    if (bytes != no_limit) integrator->keep_within(bytes);
    Rendered out;
    const auto count = std::min(2u, integrator->longest_pass());
    for (std::uint32_t sample = 0; sample < 2; sample += count) {
        Preparation p;
        p.first_sample = sample;
        p.sample_count = count;
        p.threads = threads;
        p.stop = [] { return false; };
        integrator->prepare(p);
        Tile tile = make_tile({0, 0, settings.width, settings.height}, sample, count);
        integrator->render(tile);
        out.counts.add(p.counts);
        out.counts.add(tile.cache);
        for (const PixelSums& pixel : tile.pixels) {
            for (const float x : {pixel.radiance.r, pixel.radiance.g, pixel.radiance.b})
                out.pixels.push_back(x);
            out.sum += luminance(pixel.radiance);
        }
    }
    return out;
}

class LittleMemory : public ::testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(Methods, LittleMemory,
                         ::testing::Values(Case{"records", "reproject", "image", 200'000},
                                           Case{"records_drawn_from", "reproject-mc", "image", 200'000},
                                           Case{"records_of_tiles", "reproject", "tile", 1'000'000},
                                           Case{"maps", "cache", "image", 12'000'000},
                                           Case{"maps_alone", "block-gather", "image", 3'000'000}),
                         [](const auto& c) { return c.param.name; });

TEST_P(LittleMemory, ShowsTheSameForAnyNumberOfThreads) {
    const Rendered one = rendered(GetParam(), GetParam().little, 1),
                   many = rendered(GetParam(), GetParam().little, 3), all = rendered(GetParam(), no_limit, 3);
    EXPECT_EQ(one.pixels, many.pixels);
    EXPECT_NE(one.pixels, all.pixels);        // else nothing was thinned
    EXPECT_NEAR(one.sum / all.sum, 1, 0.06);  // records serve points farther away
}

TEST_P(LittleMemory, EnoughIsLikeNoLimit) {
    EXPECT_EQ(rendered(GetParam(), std::uint64_t{1} << 40, 2).pixels,
              rendered(GetParam(), no_limit, 2).pixels);
}

TEST_P(LittleMemory, NoneAtAllIsSlowButRight) {
    const Rendered none = rendered(GetParam(), 0, 2), all = rendered(GetParam(), no_limit, 2);
    EXPECT_NEAR(none.sum / all.sum, 1, 0.03);
}

TEST(FieldOfLittleMemory, MakesTheCellsOfARadianceFieldLarger) {
    const Scene scene = project_scene("cornell-glossy.glb");
    RenderSettings settings;
    settings.method = "gather";
    settings.width = settings.height = 16;
    RenderSetup setup(scene.data(), settings, find_framing(scene.data(), settings), [](const char*) {});
    const auto field = [&](std::uint64_t bytes, int threads) {
        RayCounts rays;
        settings.threads = threads;
        return make_field(settings, setup.transport, setup.view, {}, bytes, rays);
    };
    const auto one = field(least_field_bytes(), 1), many = field(least_field_bytes(), 2);
    EXPECT_LT(one->figures().elements, 1000u);  // of many thousand
    EXPECT_GT(one->figures().elements, 100u);
    EXPECT_EQ(one->figures().elements, many->figures().elements);
    EXPECT_EQ(one->figures().links, many->figures().links);
    EXPECT_LT(one->figures().unresolved, 0.01);  // else light would be lost
}

}  // namespace
}  // namespace relumine
