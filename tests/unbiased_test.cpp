// SPDX-License-Identifier: Apache-2.0
// `path` and `gather --radiance path` are unbiased: they agree with light transport by brute force, or in
// closed form, of which they share nothing.
#include <gtest/gtest.h>

#include "tests/brute_force.hpp"
#include "tests/render_support.hpp"

namespace relumine {
namespace {

using testing::agreement_p;
using testing::block_means;
using testing::brute_force_blocks;
using testing::BruteForceScene;
using testing::Estimate;
using testing::estimate;
using testing::Panel;
using testing::Triple;

constexpr double false_positive_rate =
    1e-5;                                 // of each check below, for each scene and method; seeds are fixed
constexpr int side = 12, block_side = 4;  // pixels

/// An axis-aligned box: x, y, z of two corners; all its panels alike.
void add_box(std::vector<Panel>& panels, Triple low, Triple high, const Panel& like) {
    const Triple size{high[0] - low[0], high[1] - low[1], high[2] - low[2]};
    const std::array<Triple, 3> edges{Triple{size[0], 0, 0}, Triple{0, size[1], 0}, Triple{0, 0, size[2]}};
    for (const Triple& corner : {low, high})
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const double sign = corner == low ? 1 : -1;
            const auto edge = [&](std::size_t i) {
                const Triple& e = edges[i % 3];
                return Triple{sign * e[0], sign * e[1], sign * e[2]};
            };
            panels.push_back(
                {corner, edge(axis + 1), edge(axis + 2), like.colour, like.emission, like.alpha});
        }
}

/// Walls that all differ, a bright panel under the ceiling, a metal block on the floor.
BruteForceScene closed_room() {
    BruteForceScene room;
    room.eye = {0.1, 0.05, 1.9};
    std::vector<Panel>& panels = room.panels;
    add_box(panels, {-1, -1, -2}, {1, 1, 2}, {});
    const std::array<Triple, 6> colours{Triple{.7, .2, .2}, {.5, .5, .4}, {.3, .4, .6},
                                        {.2, .6, .3},       {.6, .6, .6}, {.4, .5, .5}};
    for (std::size_t i = 0; i < 6; ++i) {
        panels[i].colour = colours[i];
        panels[i].emission = {.05, .02 * static_cast<double>(i), .1};
    }
    panels.push_back({{-.6, .95, -1.4}, {1.1, 0, 0}, {0, 0, 1.6}, {.5, .5, .5}, {2, 1.6, 1.2}});
    Panel metal;
    metal.colour = {.9, .7, .3};
    metal.alpha = .3;
    add_box(panels, {-.7, -1.1, -1.2}, {.1, -.3, -.5}, metal);
    return room;
}

/// The same under the open sky, with a point light in it.
BruteForceScene open_room() {
    BruteForceScene room = closed_room();
    std::erase_if(room.panels,
                  [](const Panel& p) { return p.corner[1] > .99 && p.u[1] == 0 && p.v[1] == 0; });
    room.sky = {.8, 1, 1.3};
    room.lamp = {.4, .3, -.2};
    room.lamp_intensity = {.5, .4, .3};
    return room;
}

/// Estimates of each block and of the whole picture.
struct Means {
    std::vector<Estimate> blocks;
    Estimate whole;
};

/// `picture(seed)` gives means of blocks.
template <typename Picture>
Means means_of(int seeds, const Picture& picture) {
    std::vector<std::vector<double>> by_block;
    std::vector<double> whole;
    for (int seed = 1; seed <= seeds; ++seed) {
        const std::vector<double> blocks = picture(static_cast<std::uint32_t>(seed));
        by_block.resize(blocks.size());
        for (std::size_t i = 0; i < blocks.size(); ++i) by_block[i].push_back(blocks[i]);
        whole.push_back(estimate(blocks).mean);
    }
    Means means{{}, estimate(whole)};
    for (const auto& values : by_block) means.blocks.push_back(estimate(values));
    return means;
}

Means brute_force(const BruteForceScene& scene) {
    return means_of(
        24, [&](std::uint32_t seed) { return brute_force_blocks(scene, side, block_side, 64, seed); });
}

Means rendered(const Scene& scene, RenderSettings settings) {
    return means_of(16, [&](std::uint32_t seed) {
        settings.seed = seed;
        return block_means(render(scene, settings), block_side);
    });
}

RenderSettings settings_for(const std::string& method) {
    RenderSettings settings;
    settings.method = method;
    settings.radiance = "path";
    settings.width = settings.height = side;
    settings.pixel_sampling = "center";  // as the truth has it
    settings.samples_per_pixel = method == "path" ? 64 : 1;
    settings.gather_rays = 128;
    return settings;
}

/// Block means: Welch, 9 blocks, Šidák. The picture's mean: Welch; a planted bias of 1 % must be caught.
void expect_unbiased(const Means& means, const Means& truth) {
    EXPECT_GT(agreement_p(means.blocks, truth.blocks), false_positive_rate);
    EXPECT_GT(agreement_p({means.whole}, {truth.whole}), false_positive_rate)
        << means.whole.mean << " " << truth.whole.mean;
    EXPECT_LT(std::hypot(means.whole.standard_error, truth.whole.standard_error), 0.0013 * truth.whole.mean);
    for (const double scale : {0.99, 1.01})
        EXPECT_LT(agreement_p({means.whole}, {truth.whole}, scale), false_positive_rate) << scale;
}

class Unbiased : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Methods, Unbiased, ::testing::Values("path", "gather"));

TEST_P(Unbiased, InAClosedRoomWithAMetal) {
    const BruteForceScene room = closed_room();
    expect_unbiased(rendered(build(room), settings_for(GetParam())), brute_force(room));
}

TEST_P(Unbiased, UnderASkyWithAPointLight) {
    const BruteForceScene room = open_room();
    expect_unbiased(rendered(build(room), settings_for(GetParam())), brute_force(room));
}

/// A lamp behind the camera shines on a wall that fills the view: no error but the render's.
TEST_P(Unbiased, OnAWallUnderALampInClosedForm) {
    const Panel wall{{-1, -1, -1}, {2, 0, 0}, {0, 2, 0}, {.8, .5, .3}, {.01, .02, .03}};
    const Panel lamp{{-.4, -.3, .2}, {1, .1, 0}, {0, .8, .3}, {}, {3, 2, 5}};
    BruteForceScene scene;
    scene.panels = {wall, lamp};
    Means truth;
    const std::vector<double> blocks = testing::lit_by_polygon_blocks(scene, wall, lamp, side, block_side);
    for (const double mean : blocks) truth.blocks.push_back({mean, 0, 2});
    truth.whole = {estimate(blocks).mean, 0, 2};
    RenderSettings settings = settings_for(GetParam());
    settings.gather_rays = 1024;
    expect_unbiased(rendered(build(scene), settings), truth);
}

}  // namespace
}  // namespace relumine
