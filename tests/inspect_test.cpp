// SPDX-License-Identifier: Apache-2.0
// What inspect() shows of a pixel is what render() did there.
#include "relumine/inspect.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "relumine/error.hpp"
#include "tests/render_support.hpp"

namespace relumine {
namespace {

using nlohmann::json;
using testing::project_scene;

RenderSettings small_settings() {
    RenderSettings settings;
    settings.method = "reproject";
    settings.samples_per_pixel = 1;
    settings.width = 72;
    settings.height = 56;
    settings.record_size = 32;
    settings.seed = 5;
    return settings;
}

std::array<float, 3> estimate_of(const Inspection& inspection) {
    return json::parse(inspection.report_json)
        .at("outgoing_radiance")
        .at("estimate")
        .get<std::array<float, 3>>();
}

const Image& picture(const Inspection& inspection, const std::string& name) {
    const auto named = [&](const auto& entry) { return entry.first == name; };
    return std::ranges::find_if(inspection.pictures, named)->second;
}

using Pixels = std::vector<std::array<int, 2>>;
void expect_bits_of_render(const Scene& scene, const RenderSettings& settings, const Pixels& pixels) {
    const Image image = render(scene, settings);
    for (const auto& [x, y] : pixels)
        EXPECT_EQ(estimate_of(inspect(scene, settings, x, y)), image.rgb(x, y)) << x << " " << y;
}

TEST(Inspect, EstimateHasTheBitsOfTheRender) {
    RenderSettings settings = small_settings();
    settings.radiance = "emission";
    expect_bits_of_render(project_scene("shadow.glb", "sky.exr"), settings,
                          {{0, 55}, {36, 28}, {52, 48}, {71, 40}});
}

TEST(Inspect, EstimateHasTheBitsOfTheRenderWhereSurfacesReflect) {
    RenderSettings settings = small_settings();
    settings.radiance = "direct";
    expect_bits_of_render(project_scene("cornell-glossy.glb"), settings, {{20, 30}, {36, 50}, {60, 20}});
}

TEST(Inspect, MethodCropAndLayersDoNotMatter) {
    const Scene scene = project_scene("shadow.glb", "sky.exr");
    RenderSettings settings = small_settings();
    settings.radiance = "emission";
    const std::string report = inspect(scene, settings, 36, 40).report_json;
    settings.method = "reproject-mc";
    settings.crop = {0, 0, 1, 1};
    settings.aovs = {"depth"};
    settings.threads = 1;
    EXPECT_EQ(inspect(scene, settings, 36, 40).report_json, report);
}

TEST(Inspect, PicturesHaveTheSizesOfTheirSquares) {
    RenderSettings settings = small_settings();
    settings.radiance = "emission";
    const Inspection inspection = inspect(project_scene("shadow.glb", "sky.exr"), settings, 52, 48);
    ASSERT_EQ(inspection.pictures.size(), 11u);
    for (const auto& [name, image] : inspection.pictures) {
        const bool of_record = name == "record" || name == "layers" || name == "surfels";
        EXPECT_EQ(image.width, of_record ? 32 : 128) << name;
        EXPECT_EQ(image.height, image.width) << name;
        EXPECT_TRUE(image.metadata.contains("unit")) << name;
    }
}

/// The share of pixels that have exactly this colour.
double share_of_colour(const Image& image, std::array<float, 3> colour) {
    double count = 0;
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) count += image.rgb(x, y) == colour ? 1 : 0;
    return count / (image.width * image.height);
}

TEST(Inspect, MasksShowTheSharesOfTheReport) {
    RenderSettings settings = small_settings();
    settings.radiance = "emission";
    const Inspection inspection = inspect(project_scene("shadow.glb", "sky.exr"), settings, 52, 48);
    const json report = json::parse(inspection.report_json);
    json last;
    for (const json& record : report.at("records"))
        if (record.at("used")) last = record.at("after");
    const Image& masks = picture(inspection, "masks");
    EXPECT_NEAR(share_of_colour(masks, {0.05f, 0.35f, 0.12f}), last.at("covered").get<double>(), 1e-6);
    EXPECT_NEAR(share_of_colour(masks, {0.9f, 0.4f, 0.02f}), last.at("unknown").get<double>(), 1e-6);
    EXPECT_NEAR(share_of_colour(masks, {0.25f, 0.02f, 0.3f}), last.at("gaps").get<double>(), 1e-6);
    EXPECT_NEAR(share_of_colour(picture(inspection, "gap_rays"), {1, 1, 1}) * 128 * 128,
                report.at("gap_rays").get<double>(), 1e-6);
}

TEST(Inspect, ErrorIsTheSumOfItsShares) {
    RenderSettings settings = small_settings();
    settings.radiance = "emission";
    const json outgoing =
        json::parse(inspect(project_scene("shadow.glb", "sky.exr"), settings, 52, 48).report_json)
            .at("outgoing_radiance");
    for (std::size_t c = 0; c < 3; ++c) {
        const double estimate = outgoing.at("estimate")[c], truth = outgoing.at("from_true_hemisphere")[c];
        const double shares = outgoing.at("error_of_covered_bits")[c].get<double>()
                              + outgoing.at("error_of_gap_bits")[c].get<double>();
        EXPECT_NEAR(shares, estimate - truth, 1e-4 * truth);
    }
}

TEST(Inspect, RefusesPixelsThatHaveNoRecords) {
    const Scene scene = project_scene("shadow.glb", "sky.exr");
    RenderSettings settings = small_settings();
    EXPECT_THROW((void)inspect(scene, settings, 72, 0), SettingsError);
    EXPECT_THROW((void)inspect(scene, settings, 0, -1), SettingsError);
    settings.cache_scope = "tile";
    EXPECT_THROW((void)inspect(scene, settings, 0, 0), SettingsError);
    const Scene rough_glass = project_scene("furnace-rough-glass.glb");
    EXPECT_THROW((void)inspect(rough_glass, small_settings(), 36, 28), Error);
    settings = small_settings();
    settings.max_depth = 0;  // emission alone: nothing is gathered
    EXPECT_THROW((void)inspect(scene, settings, 36, 40), Error);
}

}  // namespace
}  // namespace relumine
