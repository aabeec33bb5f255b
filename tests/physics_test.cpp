// SPDX-License-Identifier: Apache-2.0
// Pictures whose every pixel is known: furnaces and the grey sphere.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/render_support.hpp"

namespace relumine {
namespace {

using testing::mean_of;
using testing::project_scene;

RenderSettings small(const std::string& method, int samples) {
    RenderSettings settings;
    settings.method = method;
    settings.samples_per_pixel = method == "gather" ? samples / 4 : samples;  // each of which gathers 64 rays
    settings.width = settings.height = 32;
    settings.gather_rays = 64;
    return settings;
}

/// Largest deviation of any pixel and channel from `value`.
double worst_deviation(const Image& image, double value) {
    double worst = 0;
    for (const float pixel : image.layer()->pixels) worst = std::max(worst, std::abs(pixel - value));
    return worst;
}

class EveryMethod : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Physics, EveryMethod, ::testing::Values("path", "gather"));

TEST_P(EveryMethod, ClosedFurnaceIsOneEverywhere) {  // emission 1 − ρ, albedo ρ: (1 − ρ)(1 + ρ + ρ² + …) = 1
    const int samples = GetParam() == std::string("path") ? 256 : 64;
    for (const char* name : {"furnace-walls-50.glb", "furnace-walls-80.glb"}) {
        const Image image = render(project_scene(name), small(GetParam(), samples));
        EXPECT_NEAR(mean_of(image), 1, 0.003) << name;  // three standard errors where ρ = .8
        EXPECT_LT(worst_deviation(image, 1), 0.25) << name;
    }
}

TEST_P(EveryMethod, FurnaceOfLimitedDepthIsItsPartialSum) {  // emission .5, albedo .5: ½ + ¼ + …
    RenderSettings settings = small(GetParam(), 64);
    for (int depth = 0; depth < 4; ++depth) {
        settings.max_depth = depth;
        EXPECT_NEAR(mean_of(render(project_scene("furnace-walls-50.glb"), settings)),
                    1 - std::pow(0.5, depth + 1), 0.003)
            << depth;
    }
}

TEST_P(EveryMethod, GreySphereIsOneEverywhere) {  // radius 1, albedo ½, light of intensity π at the centre
    const Image image = render(project_scene("grey-sphere.glb"), small(GetParam(), 64));
    EXPECT_NEAR(mean_of(image), 1, 0.005);
    EXPECT_LT(worst_deviation(image, 1), 0.1);
}

TEST_P(EveryMethod, LosslessBodiesVanishInAWhiteSky) {
    for (const char* name : {"furnace-diffuse.glb", "furnace-glass.glb"}) {
        const Image image = render(project_scene(name, "white.pfm"), small(GetParam(), 64));
        EXPECT_NEAR(mean_of(image), 1, 0.001) << name;
        EXPECT_LT(worst_deviation(image, 1), 0.5)
            << name;  // paths caught along the glass sphere's rim meet Russian roulette
    }
}

TEST_P(EveryMethod, RoughBodiesLoseWhatSingleScatteringLoses) {  // scenes/README.md: .987 and about .97
    for (const auto& [name, expected] :
         {std::pair{"furnace-metal.glb", 0.987}, {"furnace-rough-glass.glb", 0.97}}) {
        const Image image = render(project_scene(name, "white.pfm"), small(GetParam(), 64));
        EXPECT_NEAR(mean_of(image), expected, 0.005) << name;
    }
}

TEST_P(EveryMethod, TheCoatOverWhiteGainsNothing) {  // as glTF 2.0, appendix B, writes it: 1.017
    const Image image = render(project_scene("furnace-dielectric.glb", "white.pfm"), small(GetParam(), 64));
    EXPECT_LT(mean_of(image), 1.001);
    EXPECT_NEAR(mean_of(image), 0.998, 0.003);  // docs/physics.md
}

}  // namespace
}  // namespace relumine
