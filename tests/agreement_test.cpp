// SPDX-License-Identifier: Apache-2.0
// Methods that must agree do, by Welch's test over block means; a planted bias of 1 % is caught.
#include <gtest/gtest.h>

#include "tests/render_support.hpp"

namespace relumine {
namespace {

using testing::agreement_p;
using testing::block_estimates;
using testing::Estimate;
using testing::project_scene;

constexpr double false_positive_rate = 1e-4;  // of each test below
constexpr int seeds = 12, side = 12;

RenderSettings small(const std::string& method, int samples) {
    RenderSettings settings;
    settings.method = method;
    settings.samples_per_pixel = samples;
    settings.width = settings.height = 36;
    settings.gather_rays = 16;
    return settings;
}

std::vector<Estimate> estimates(const Scene& scene, const RenderSettings& settings) {
    return block_estimates(scene, settings, seeds, side);
}

/// The whole picture as one block: where the planted bias must show.
std::vector<Estimate> whole(const Scene& scene, const RenderSettings& settings) {
    return block_estimates(scene, settings, seeds, settings.width);
}

struct Case {
    const char *scene, *environment;
};
constexpr std::array cases{Case{"cornell-glossy.glb", ""}, Case{"validation/room.glb", ""},
                           Case{"validation/open.glb", "validation/sky.pfm"}};

class Agreement : public ::testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(Scenes, Agreement, ::testing::ValuesIn(cases));

TEST_P(Agreement, GatherWithPathsIsPath) {
    const Scene scene = project_scene(GetParam().scene, GetParam().environment);
    RenderSettings gather = small("gather", 16);
    gather.radiance = "path";
    gather.max_depth = 6;
    RenderSettings path = small("path", 256);
    path.max_depth = 6;
    EXPECT_GT(agreement_p(estimates(scene, gather), estimates(scene, path)), false_positive_rate);
}

TEST_P(Agreement, GatherOfEmissionIsPathOfDepthOne) {
    const Scene scene = project_scene(GetParam().scene, GetParam().environment);
    RenderSettings gather = small("gather", 16);
    gather.radiance = "emission";
    RenderSettings path = small("path", 256);
    path.max_depth = 1;
    const auto expected = estimates(scene, path);
    EXPECT_GT(agreement_p(estimates(scene, gather), expected), false_positive_rate);
    gather.light_samples = 4;
    EXPECT_GT(agreement_p(estimates(scene, gather), expected), false_positive_rate);
}

TEST_P(Agreement, APlantedBiasOfOnePercentIsCaught) {
    const Scene scene = project_scene(GetParam().scene, GetParam().environment);
    RenderSettings gather = small("gather", 16);
    gather.radiance = "emission";
    gather.light_samples = 16;
    RenderSettings path = small("path", 256);
    path.max_depth = 1;
    gather.pixel_sampling = path.pixel_sampling = "center";  // no noise from the edges of the lights in view
    const auto found = whole(scene, gather), expected = whole(scene, path);
    EXPECT_GT(agreement_p(found, expected), false_positive_rate);
    EXPECT_LT(agreement_p(found, expected, 1.01), false_positive_rate);
}

TEST_P(Agreement, PointSetsAgree) {
    const Scene scene = project_scene(GetParam().scene, GetParam().environment);
    RenderSettings sobol = small("path", 64), stratified = sobol, independent = sobol;
    stratified.sampler = "stratified";
    independent.sampler = "independent";
    const auto reference = estimates(scene, sobol);
    EXPECT_GT(agreement_p(estimates(scene, stratified), reference), false_positive_rate);
    EXPECT_GT(agreement_p(estimates(scene, independent), reference), false_positive_rate);
}

}  // namespace
}  // namespace relumine
