// SPDX-License-Identifier: Apache-2.0
// `relumine inspect` as its users meet it.
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "cli_workplace.hpp"
#include "relumine/image.hpp"

namespace relumine::test {
namespace {

using nlohmann::json;

const std::vector<std::string> picture_names{"record",  "layers",   "surfels", "reprojected",
                                             "masks",   "gap_rays", "filled",  "bsdf",
                                             "product", "truth",    "error"};

struct Inspected : Workplace {
    Inspected() { std::filesystem::create_directory(out); }

    [[nodiscard]] CommandResult inspect(const std::string& pixel, const std::vector<std::string>& more = {},
                                        const RunOptions& options = {}) const {
        std::vector<std::string> arguments{"inspect", scene, "--pixel", pixel,
                                           "--out",   out,   "--size",  "16x16"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return run_relumine(arguments, options);
    }

    std::string out = folder / "pictures";
};

TEST(CliInspect, WritesEveryPictureAndPrintsTheReport) {
    const Inspected work;
    const CommandResult result = work.inspect("8,8");
    EXPECT_EQ(result.exit_code, 0);
    EXPECT_EQ(result.err, "");
    for (const char* words : {"pixel         8,8 of 16 x 16\n", "record ", "% covered", "gap rays ",
                              "estimated", "from the true hemisphere"})
        EXPECT_NE(result.out.find(words), std::string::npos) << words << "\n" << result.out;
    for (const std::string& name : picture_names) {
        const Image image = read_image(work.out + "/" + name + ".png");
        EXPECT_EQ(image.width, 512) << name;
        EXPECT_EQ(image.height, 512) << name;
    }
    const auto files = std::filesystem::directory_iterator(work.out);
    EXPECT_EQ(std::distance(files, {}), static_cast<std::ptrdiff_t>(picture_names.size()));
}

TEST(CliInspect, ReportIsJsonIfWanted) {
    const Inspected work;
    const json report = json::parse(work.inspect("8,8", {"--json"}).out);
    for (const char* key :
         {"pixel", "frame", "position", "geometric_normal", "shading_normal", "material", "camera_distance",
          "mirrors_before", "footprint", "records", "gap_rays", "outgoing_radiance", "picture_scales"})
        EXPECT_TRUE(report.contains(key)) << key;
    ASSERT_FALSE(report.at("records").empty());
    for (const char* key :
         {"id", "pixel", "pixel_reach", "position", "distance", "height", "normal_angle_degrees",
          "unsuitability", "reach", "nearest_distance", "harmonic_distance", "side", "surfels",
          "surfels_at_infinity", "layers", "bytes", "used", "after"})
        EXPECT_TRUE(report.at("records")[0].contains(key)) << key;
}

TEST(CliInspect, EstimateIsThePixelOfTheRender) {
    const Inspected work;
    expect_silent_success(work.render({"--method", "reproject", "--seed", "7"}));
    const json report = json::parse(work.inspect("5,9", {"--seed", "7", "--json"}).out);
    EXPECT_EQ((report.at("outgoing_radiance").at("estimate").get<std::array<float, 3>>()),
              read_image(work.picture).rgb(5, 9));
}

TEST(CliInspect, ExposureIsForRadianceAlone) {
    const Inspected work;
    const auto bytes = [&](const char* name) { return read_bytes(work.out + "/" + name + ".png"); };
    EXPECT_EQ(work.inspect("8,8").exit_code, 0);
    const std::string masks = bytes("masks"), reprojected = bytes("reprojected"), bsdf = bytes("bsdf");
    EXPECT_EQ(
        work.inspect("8,8", {"--environment", RELUMINE_SOURCE_DIR "/scenes/white.pfm", "--exposure", "-2"})
            .exit_code,
        0);
    EXPECT_EQ(bytes("masks"), masks);
    EXPECT_EQ(bytes("bsdf"), bsdf);
    EXPECT_NE(bytes("reprojected"), reprojected);
}

TEST(CliInspect, ReplacesPicturesWholeOrNotAtAll) {
    const Inspected work;
    const std::string record = work.out + "/record.png";
    write_bytes(record, "old picture");
    RunOptions full_disk;
    full_disk.file_limit = 100;  // bytes
    expect_one_line(work.inspect("8,8", {}, full_disk), 1, "record.png");
    EXPECT_EQ(read_bytes(record), "old picture");
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(work.out), {}), 1);
    EXPECT_EQ(work.inspect("8,8").exit_code, 0);
    EXPECT_EQ(read_image(record).width, 512);
}

TEST(CliInspect, RefusesBadUsage) {
    const Inspected work;
    expect_one_line(run_relumine({"inspect", work.scene, "--out", work.out}), 2, "--pixel");
    expect_one_line(run_relumine({"inspect", work.scene, "--pixel", "8,8"}), 2, "--out");
    for (const char* pixel : {"8", "8,", ",8", "8x8", "8,8,8", "a,b", ""})
        expect_one_line(work.inspect(pixel), 2, "--pixel: expected X,Y");
    expect_one_line(work.inspect("16,0"), 2, "pixel: expected 0,0 to 15,15, found 16,0");
    expect_one_line(work.inspect("0,-1"), 2, "found 0,-1");
    expect_one_line(work.inspect("8,8", {"--spp", "4"}), 2, "--spp");
    expect_one_line(work.inspect("8,8", {"--record-size", "17"}), 2, "record size");
    expect_one_line(work.inspect("8,8", {"--camera", "nobody"}), 2, "nobody");
    EXPECT_TRUE(std::filesystem::is_empty(work.out));
}

TEST(CliInspect, FoldersAreCheckedBeforeTheWorkBegins) {
    const std::vector<std::pair<std::string, std::string>> cases{{"/nowhere/at/all", "existing folder"},
                                                                 {"/proc", "/proc"}};
    for (const auto& [folder, words] : cases)  // the scene does not exist, but that comes later
        expect_one_line(run_relumine({"inspect", "no.glb", "--pixel", "0,0", "--out", folder}), 1, words);
}

TEST(CliInspect, APixelWithoutASurfaceIsAnError) {
    const Inspected work;
    json gltf = tiny_gltf();
    gltf["nodes"][0]["translation"] = {100, 0, -2};  // beside the view
    write_bytes(work.scene, gltf.dump());
    expect_one_line(work.inspect("3,4"), 1, "pixel 3,4: expected a surface");
    EXPECT_TRUE(std::filesystem::is_empty(work.out));
}

}  // namespace
}  // namespace relumine::test
