// SPDX-License-Identifier: Apache-2.0
// Paths that a radiance field guides bring what plain paths do.
#include <gtest/gtest.h>

#include "tests/render_support.hpp"

namespace relumine {
namespace {

using testing::agreement_p;
using testing::estimate;
using testing::mean_of;
using testing::project_scene;
using testing::welch_p;

constexpr double false_positive_rate = 1e-5;  // of each check; seeds are fixed

struct Case {
    const char *name, *scene, *environment;
    int samples, seeds;
};
const Case cases[] = {{"sky", "shadow.glb", "white.pfm", 256, 8}, {"room", "cornell.glb", "", 640, 8}};

RenderSettings settings_for(const Case& c) {
    RenderSettings settings;
    settings.method = "path";
    settings.width = settings.height = 12;
    settings.samples_per_pixel = c.samples;
    settings.max_depth = 4;
    return settings;
}

class GuidedPath : public ::testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(Scenes, GuidedPath, ::testing::ValuesIn(cases),
                         [](const auto& c) { return c.param.name; });

/// The picture's mean over seeds: Welch; a planted bias of 1 % must be caught.
TEST_P(GuidedPath, ItsMeanIsThatOfPlainPaths) {
    const Scene scene = project_scene(GetParam().scene, GetParam().environment);
    const auto means = [&](const char* guide) {
        RenderSettings settings = settings_for(GetParam());
        settings.guide = guide;
        std::vector<double> values;
        for (int seed = 1; seed <= GetParam().seeds; ++seed) {
            settings.seed = static_cast<std::uint64_t>(seed);
            values.push_back(mean_of(render(scene, settings)));
        }
        return estimate(values);
    };
    const auto plain = means("none");
    auto guided = means("field");
    EXPECT_NE(guided.mean, plain.mean);  // it does something
    EXPECT_GT(welch_p(guided, plain), false_positive_rate) << guided.mean << " " << plain.mean;
    for (const double scale : {0.99, 1.01})
        EXPECT_LT(welch_p({scale * guided.mean, scale * guided.standard_error, guided.count}, plain),
                  false_positive_rate)
            << scale << " " << guided.standard_error / guided.mean << " "
            << plain.standard_error / plain.mean;
}

TEST(Guide, IsMissedWhereTheMethodHasNoUseForIt) {
    class Listener : public RenderObserver {
      public:
        void warning(const std::string& text) override { warnings.push_back(text); }
        std::vector<std::string> warnings;
    };
    const auto warnings = [](const char* method, bool unbiased) {
        RenderSettings settings = settings_for(cases[0]);
        settings.method = method;
        settings.unbiased = unbiased;
        settings.samples_per_pixel = settings.max_depth = 1;
        settings.guide = "field";
        Listener listener;
        (void)render(project_scene("cornell.glb"), settings, &listener);
        return listener.warnings;
    };
    EXPECT_EQ(
        warnings("cache", false),
        (std::vector<std::string>{"guide: expected --method path or cache --unbiased, found cache, which "
                                  "does not use it"}));
    EXPECT_TRUE(warnings("cache", true).empty());
    EXPECT_TRUE(warnings("path", false).empty());
}

}  // namespace
}  // namespace relumine
