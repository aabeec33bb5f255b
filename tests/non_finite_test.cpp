// SPDX-License-Identifier: Apache-2.0
// Samples that are not finite: dropped, counted and replayed, by every method.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "relumine/error.hpp"
#include "scene/scene_data.hpp"
#include "tests/keep_support.hpp"

namespace relumine {
namespace {

using testing::no_end;
using testing::project_scene;
using testing::small_settings;
using testing::StopAfter;

using Corner = std::array<float, 3>;

void add_square(SceneBuilder& builder, float half, float z, float emission) {
    MaterialDescription material;
    material.emission = {emission, emission, emission};
    const std::vector<Corner> corners{{-half, -half, z}, {half, -half, z}, {half, half, z}, {-half, half, z}};
    const std::vector<std::array<std::uint32_t, 3>> triangles{{0, 1, 2}, {0, 2, 3}};
    builder.add_instance(builder.add_mesh({"", corners, {}, {}, triangles, builder.add_material(material)}));
}

constexpr float not_a_number = std::numeric_limits<float>::quiet_NaN();

/// A wall of radiance 1, and before it a small square of this radiance; nothing but the camera sees it. At
/// 3.2e38 no sum of two samples of it is finite.
Scene scene_with_poison(float radiance) {
    SceneBuilder builder;
    add_square(builder, 10, -4, 1);
    add_square(builder, 0.5f, -2, std::isnan(radiance) ? 1 : radiance);
    CameraDescription camera;
    camera.vertical_fov = 0.9;
    builder.add_camera(camera);
    Scene scene = builder.build();
    if (!std::isnan(radiance)) return scene;
    SceneData data = scene.data();  // no reader lets it in
    data.materials[1].emission = Spectrum{1, radiance, 1};
    return Scene(std::make_shared<const SceneData>(std::move(data)));
}

class NonFinite : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Methods, NonFinite,
                         ::testing::Values("path", "gather", "reproject", "reproject-mc", "cache",
                                           "block-gather", "irradiance-cache", "radiance-cache"));

void expect_dropped_counted_and_replayed(const Scene& scene, const std::string& method) {
    RenderSettings settings = small_settings(method);
    settings.aovs = {"samples"};
    settings.max_depth = 0;  // emission alone
    StopAfter observer(no_end);
    const Image image = render(scene, settings, &observer);
    std::uint64_t poisoned = 0;
    const auto all = static_cast<std::uint64_t>(settings.samples_per_pixel);
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) {
            const auto n = static_cast<std::uint64_t>(
                image.layer("samples")->pixels[static_cast<std::size_t>(y * image.width + x)]);
            poisoned += all - n;
            EXPECT_EQ(image.rgb(x, y)[0], n > 0 ? 1.0f : 0.0f) << x << ", " << y;
        }
    EXPECT_GT(poisoned, 50u);
    EXPECT_EQ(observer.stats.non_finite_samples, poisoned);
    EXPECT_EQ(observer.stats.samples, 36u * 20u * all - poisoned);
    ASSERT_TRUE(observer.stats.first_non_finite);
    const auto [x, y, sample] = *observer.stats.first_non_finite;
    EXPECT_FALSE(replay_sample(scene, settings, static_cast<int>(x), static_cast<int>(y),
                               static_cast<std::uint32_t>(sample))
                     .finite);
    const ReplayedSample healthy = replay_sample(scene, settings, 0, 0, 3);
    EXPECT_TRUE(healthy.finite);
    EXPECT_EQ(healthy.emission, (std::array<float, 3>{1, 1, 1}));
}

TEST_P(NonFinite, SamplesThatOverflowAreDroppedCountedAndReplayed) {
    expect_dropped_counted_and_replayed(scene_with_poison(3.2e38f), GetParam());
}

TEST_P(NonFinite, PlantedNansAreDroppedCountedAndReplayed) {
    expect_dropped_counted_and_replayed(scene_with_poison(not_a_number), GetParam());
}

TEST_P(NonFinite, ReplayedSamplesAddUpToThePixel) {
    const Scene scene = project_scene("cornell-glossy.glb", "sky.exr");
    RenderSettings settings = small_settings(GetParam());
    settings.aovs.clear();
    settings.filter_residual = false;  // it mixes pixels
    const Image image = render(scene, settings);
    for (const auto& [x, y] : {std::pair{3, 4}, std::pair{17, 12}}) {
        double sum = 0;
        for (int i = 0; i < settings.samples_per_pixel; ++i) {
            const ReplayedSample s = replay_sample(scene, settings, x, y, static_cast<std::uint32_t>(i));
            sum += double{s.emission[1]} + s.direct[1] + s.indirect[1];
        }
        const double mean = sum / settings.samples_per_pixel;
        EXPECT_NEAR(image.rgb(x, y)[1], mean, 1e-6 + 1e-5 * mean) << x << ", " << y;
    }
}

TEST(NonFinite, ReplayRefusesWhatIsNotThere) {
    const Scene scene = project_scene("cornell.glb");
    const RenderSettings settings = small_settings("path");
    EXPECT_THROW((void)replay_sample(scene, settings, 36, 0, 0), SettingsError);
    EXPECT_THROW((void)replay_sample(scene, settings, 0, -1, 0), SettingsError);
    EXPECT_THROW((void)replay_sample(scene, settings, 0, 0, 5), SettingsError);
}

}  // namespace
}  // namespace relumine
