// SPDX-License-Identifier: Apache-2.0
// A scene far from the origin, or much larger or smaller, gives the same picture: no acne, no leaks.
#include <gtest/gtest.h>

#include "scene/finish_scene.hpp"
#include "scene/readers.hpp"
#include "tests/render_support.hpp"

namespace relumine {
namespace {

using testing::agreement_p;
using testing::block_estimates;

constexpr double false_positive_rate = 1e-4;  // of each test

Transform placement(double scale, Vec3 offset) {
    Transform t;
    for (std::size_t i = 0; i < 3; ++i) {
        t.m[i][i] = scale;
        t.m[i][3] = offset[static_cast<int>(i)];
    }
    return t;
}

/// The project's scene with everything in it moved and scaled.
Scene placed(const std::string& name, const Transform& world_from_scene) {
    const std::string folder = RELUMINE_SOURCE_DIR "/scenes/";
    SceneData data = read_gltf(folder + name);
    for (Instance& instance : data.instances)
        instance.world_from_object = world_from_scene * instance.world_from_object;
    for (Camera& camera : data.cameras)
        camera.world_from_camera = world_from_scene * camera.world_from_camera;
    data.environment = read_environment(folder + "validation/sky.pfm", data.warnings);
    return Scene(std::make_shared<const SceneData>(finish_scene(std::move(data))));
}

struct Placement {
    double scale;
    Vec3 offset;
};

class Robustness : public ::testing::TestWithParam<Placement> {};
INSTANTIATE_TEST_SUITE_P(Placements, Robustness,
                         ::testing::Values(Placement{1, {1000, -1000, 1000}}, Placement{1000, {}},
                                           Placement{0.001, {}}));

RenderSettings small() {
    RenderSettings settings;
    settings.method = "path";
    settings.samples_per_pixel = 64;
    settings.width = settings.height = 36;
    settings.max_depth = 6;
    return settings;
}

TEST_P(Robustness, PlacementDoesNotChangeThePicture) {
    const Transform there = placement(GetParam().scale, GetParam().offset);
    for (const char* name : {"cornell-glossy.glb", "validation/open.glb"}) {
        const auto here = block_estimates(placed(name, {}), small(), 8, 6);
        EXPECT_GT(agreement_p(block_estimates(placed(name, there), small(), 8, 6), here), false_positive_rate)
            << name;
    }
}

TEST(Robustness, ALeakOfOnePercentIsCaught) {
    const auto here = block_estimates(placed("cornell-glossy.glb", {}), small(), 8, 36);
    EXPECT_LT(agreement_p(here, here, 1.01), false_positive_rate);
}

}  // namespace
}  // namespace relumine
