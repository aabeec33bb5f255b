// SPDX-License-Identifier: Apache-2.0
// The command as its users meet it: pictures, streams, signals, exit codes.
#include <gtest/gtest.h>

#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>

#include "cli_workplace.hpp"
#include "relumine/image.hpp"

namespace relumine::test {
namespace {

using nlohmann::json;

std::vector<json> parse_lines(const std::string& text) {
    std::vector<json> lines;
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);) lines.push_back(json::parse(line));
    return lines;
}

std::vector<json> of_kind(const std::vector<json>& events, const std::string& kind) {
    std::vector<json> chosen;
    for (const json& event : events)
        if (event.at("event") == kind) chosen.push_back(event);
    return chosen;
}

// ---- pictures

TEST(CliRender, WritesEveryFormatAtOnce) {
    const Workplace work;
    expect_silent_success(work.render({"-o", work.folder / "out.png", "-o", work.folder / "OUT.PFM"}));
    EXPECT_EQ(read_bytes(work.folder / "out.png").substr(1, 3), "PNG");
    EXPECT_EQ(read_bytes(work.folder / "OUT.PFM").substr(0, 2), "PF");
    EXPECT_EQ(read_bytes(work.picture).substr(0, 4), "\x76\x2f\x31\x01");
}

TEST(CliRender, AnEmitterThatFillsTheViewIsOneEverywhere) {
    const Workplace work;
    expect_silent_success(work.render({}));
    const Image image = read_image(work.picture);
    ASSERT_EQ(image.width, 16);
    for (int y = 0; y < 16; ++y)
        for (int x = 0; x < 16; ++x) EXPECT_NEAR(image.rgb(x, y)[1], 1, 1e-5);
}

TEST(CliRender, HeaderHoldsTheCommand) {
    const Workplace work;
    expect_silent_success(work.render({"--seed", "5"}));
    const auto metadata = read_image(work.picture).metadata;
    ASSERT_EQ(metadata.count("relumine.command"), 1u);
    EXPECT_EQ(metadata.at("relumine.command"),
              "relumine render " + work.scene + " -o " + work.picture + " --size 16x16 --spp 1 --seed 5");
    for (const char* key : {"relumine.version", "relumine.seed", "relumine.samples", "relumine.seconds"})
        EXPECT_EQ(metadata.count(key), 1u) << key;
}

TEST(CliRender, FurtherLayersAndHalfFloats) {
    const Workplace work;
    expect_silent_success(work.render({"--aov", "albedo,depth", "--half"}));
    const Image image = read_image(work.picture);
    EXPECT_NE(image.layer("albedo"), nullptr);
    EXPECT_NE(image.layer("depth"), nullptr);
}

TEST(CliRender, CropIsPartOfTheFrame) {
    const Workplace work;
    expect_silent_success(work.render({"--crop", "4", "2", "12", "6"}));
    const Image image = read_image(work.picture);
    EXPECT_EQ(image.window, (PixelRect{4, 2, 12, 6}));
    EXPECT_EQ(image.frame_width, 16);
}

TEST(CliRender, ThreadsDoNotChangeThePicture) {
    const Workplace work;
    expect_silent_success(work.render({"-o", work.folder / "one.pfm", "--threads", "1"}));
    expect_silent_success(work.render({"-o", work.folder / "two.pfm", "--threads", "2"}));
    EXPECT_EQ(read_bytes(work.folder / "one.pfm"), read_bytes(work.folder / "two.pfm"));
}

TEST(CliRender, CameraByNameAndByIndex) {
    const Workplace work;
    expect_silent_success(work.render({"--camera", "main"}));
    expect_silent_success(work.render({"--camera", "0"}));
}

// ---- outputs that cannot be

TEST(CliOutput, IsCheckedBeforeTheWorkBegins) {
    const ScratchFolder folder;
    std::filesystem::create_directory(folder / "folder.png");
    const std::vector<std::pair<std::string, std::string>> cases{
        {folder / "nowhere/a.png", "existing folder"},
        {"/proc/a.png", "/proc"},
        {folder / "folder.png", "found a folder"}};
    for (const auto& [path, words] : cases)  // the scene does not exist, but that comes later
        expect_one_line(run_relumine({"render", "no.glb", "-o", path}), 1, words);
    expect_one_line(
        run_relumine({"render", "no.glb", "-o", folder / "a.png", "--stats", folder / "no/s.json"}), 1,
        "s.json");
}

TEST(CliOutput, FullDiskKeepsTheOldPicture) {
    const Workplace work;
    write_bytes(work.picture, "old picture");
    RunOptions full_disk;
    full_disk.file_limit = 100;  // bytes
    expect_one_line(work.render({}, full_disk), 1, "out.exr");
    EXPECT_EQ(read_bytes(work.picture), "old picture");
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(work.folder.path()), {}), 2);
}

TEST(CliOutput, OneFailureDoesNotCostTheOthers) {
    const Workplace work;
    expect_one_line(work.render({"--stats", "/dev/full"}), 1, "/dev/full");
    EXPECT_EQ(read_image(work.picture).width, 16);
}

TEST(CliOutput, ClosedOrBrokenStdoutDoesNotCostThePicture) {
    const Workplace work;
    RunOptions closed, broken;
    closed.close_stdout = true;
    broken.break_pipe = true;
    EXPECT_EQ(work.render({"--json-events"}, closed).exit_code, 0);
    EXPECT_EQ(read_image(work.picture).width, 16);
    std::filesystem::remove(work.picture);
    EXPECT_EQ(work.render({"--json-events"}, broken).exit_code, 0);
    EXPECT_EQ(read_image(work.picture).width, 16);
}

// ---- what it says while it works

TEST(CliStreams, WarningsComeOnceAndNotWithQuiet) {
    const Workplace work;
    json gltf = tiny_gltf();
    gltf["extensionsUsed"] = {"EXT_from_nowhere"};
    write_bytes(work.scene, gltf.dump());
    expect_one_line(work.render({}), 0, "relumine: warning: ");
    expect_silent_success(work.render({"-q"}));
    const CommandResult events = work.render({"-q", "--json-events"});
    EXPECT_EQ(events.err, "");
    EXPECT_EQ(of_kind(parse_lines(events.out), "warning").size(), 1u);
}

TEST(CliStreams, EventsAreJsonLines) {
    const Workplace work;
    const CommandResult result = work.render({"--json-events"});
    EXPECT_EQ(result.exit_code, 0);
    EXPECT_EQ(result.err, "");
    const std::vector<json> events = parse_lines(result.out);
    ASSERT_FALSE(events.empty());
    for (const json& event : of_kind(events, "progress"))
        for (const char* key : {"stage", "done", "total", "rays", "seconds", "seconds_left"})
            EXPECT_TRUE(event.contains(key)) << event;
    EXPECT_FALSE(of_kind(events, "progress").empty());
    EXPECT_FALSE(of_kind(events, "tile").empty());
    EXPECT_EQ(events.back().at("event"), "finished");
    EXPECT_EQ(events.back().at("exit_code"), 0);
    EXPECT_EQ(events.back().at("stats").at("samples"), 256);
}

TEST(CliStreams, ErrorIsAnEventToo) {
    const Workplace work;
    write_bytes(work.scene, "{");
    const CommandResult result = work.render({"--json-events"});
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_EQ(line_count(result.err), 1u);
    const json last = parse_lines(result.out).back();
    EXPECT_EQ(last.at("event"), "error");
    EXPECT_EQ(last.at("exit_code"), 1);
    EXPECT_NE(result.err.find(last.at("message").get<std::string>()), std::string::npos);
}

TEST(CliStreams, StatisticsHaveTheDocumentedKeys) {
    const Workplace work;
    expect_silent_success(work.render({"--stats", work.folder / "stats.json"}));
    const json stats = json::parse(read_bytes(work.folder / "stats.json"));
    for (const char* key : {"version", "command", "outputs", "stage_seconds", "total_seconds", "cpu_seconds",
                            "rays", "total_rays", "samples", "non_finite_samples", "peak_memory_bytes",
                            "threads", "stopped", "picture", "settings", "scene"})
        EXPECT_TRUE(stats.contains(key)) << key;
    EXPECT_EQ(stats.at("samples"), 256);
    EXPECT_EQ(stats.at("settings").at("samples_per_pixel"), 1);
    EXPECT_EQ(stats.at("picture").at("width"), 16);
    EXPECT_EQ(stats.at("scene").at("triangles"), 2);

    const CommandResult printed = work.render({"--stats", "-"});
    EXPECT_EQ(printed.err, "");
    EXPECT_EQ(json::parse(printed.out).at("samples"), 256);
}

TEST(CliStreams, BarIsForTerminalsAlone) {
    if (!terminals_available()) GTEST_SKIP() << "expected pseudo-terminals, found none on this machine";
    const Workplace work;
    RunOptions terminal;
    terminal.terminal = true;
    const std::string seen = work.render({"--spp", "16"}, terminal).err;
    EXPECT_NE(seen.find(" %"), std::string::npos) << seen;
    EXPECT_NE(seen.find("Mrays/s"), std::string::npos) << seen;
    EXPECT_EQ(work.render({"--no-progress"}, terminal).err, "");
    EXPECT_EQ(work.render({"-q"}, terminal).err, "");
    EXPECT_EQ(work.render({}).err, "");
}

// ---- signals

const std::vector<std::string> endless{"--spp", "500000", "--json-events"};
const std::string first_tile = "\"event\":\"tile\"";

TEST(CliSignal, FirstInterruptSavesThePictureSoFar) {
    const Workplace work;
    RunOptions interrupt;
    interrupt.interrupt_when = first_tile;
    const CommandResult result = work.render(endless, interrupt);
    EXPECT_EQ(result.exit_code, 3) << result.err;
    const json last = parse_lines(result.out).back();
    EXPECT_EQ(last.at("event"), "finished");
    EXPECT_EQ(last.at("exit_code"), 3);
    EXPECT_TRUE(last.at("stats").at("stopped"));
    EXPECT_NEAR(read_image(work.picture).rgb(8, 8)[1], 1, 1e-5);
}

TEST(CliSignal, SecondInterruptEndsAtOnceAndKeepsTheOldPicture) {
    const Workplace work;
    write_bytes(work.picture, "old picture");
    RunOptions interrupt;
    interrupt.interrupt_when = first_tile;
    interrupt.insist = true;
    const CommandResult result = work.render(endless, interrupt);
    EXPECT_GT(result.exit_code, 128);
    EXPECT_EQ(read_bytes(work.picture), "old picture");
}

// ---- info

TEST(CliInfo, TellsWhatTheSceneHolds) {
    const Workplace work;
    const CommandResult text = run_relumine({"info", work.scene});
    EXPECT_EQ(text.exit_code, 0);
    EXPECT_NE(text.out.find("2 triangles"), std::string::npos) << text.out;
    EXPECT_NE(text.out.find("0 \"main\""), std::string::npos) << text.out;
    const json info = json::parse(run_relumine({"info", work.scene, "--json"}).out);
    EXPECT_EQ(info.at("triangles"), 2);
    EXPECT_EQ(info.at("emissive_triangles"), 2);
    EXPECT_EQ(info.at("cameras"), json{"main"});
}

TEST(CliInfo, FilesOutsideTheScenesFolderNeedLeave) {
    const ScratchFolder folder;
    for (const char* name : {"scene", "library", "more"}) std::filesystem::create_directory(folder / name);
    write_bytes(folder / "scene/a.pbrt",
                "WorldBegin\nInclude \"../library/b.pbrt\"\nInclude \"../more/b.pbrt\"\n");
    for (const char* name : {"library/b.pbrt", "more/b.pbrt"})
        write_bytes(folder / name, "Shape \"sphere\"\n");
    const std::string scene = folder / "scene/a.pbrt", library = folder / "library", more = folder / "more";
    expect_one_line(run_relumine({"info", scene}), 1, "a file inside the scene's folder");
    expect_one_line(run_relumine({"info", scene, "--allow-dir", library}), 1, "../more/b.pbrt");
    EXPECT_EQ(run_relumine({"info", "--allow-dir", library, "--allow-dir", more, scene}).exit_code, 0);
    expect_one_line(run_relumine({"info", scene, "--allow-dir", folder / "none"}), 2, "an existing folder");
    const std::vector<std::string> render{"render", scene, "-o", folder / "a.png", "--spp", "1",
                                          "--size", "4x4", "-q", "--allow-dir",    library};
    EXPECT_EQ(run_relumine(render).exit_code, 1);
    std::vector<std::string> allowed = render;
    allowed.insert(allowed.end(), {"--allow-dir", more});
    EXPECT_EQ(run_relumine(allowed).exit_code, 0);
}

TEST(CliInfo, MissingSceneIsOneLine) { expect_one_line(run_relumine({"info", "no.glb"}), 1, "no.glb"); }

// ---- compare

/// A grey picture of 2 × 1 pixels and a reference, and how the command compares them.
struct Pair {
    ScratchFolder folder;
    std::string image = folder / "image.pfm", reference = folder / "reference.pfm";

    Pair(float left, float right) {
        write_bytes(image, pfm_of({left, left, left, right, right, right}));
        write_bytes(reference, pfm_of({1, 1, 1, 1, 1, 1}));
    }
    [[nodiscard]] CommandResult compare(const std::vector<std::string>& more) const {
        std::vector<std::string> arguments{"compare", image, reference};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return run_relumine(arguments);
    }
};

TEST(CliCompare, PrintsTheNumbers) {
    const Pair pair(1, 1.5f);
    const CommandResult text = pair.compare({});
    EXPECT_EQ(text.exit_code, 0);
    for (const char* word :
         {"relative L1    0.25\n", "RMSE ", "relMSE ", "FLIP ", "mean ratio     1.25\n", "blocks of 16"})
        EXPECT_NE(text.out.find(word), std::string::npos) << word << "\n" << text.out;
    const json numbers = json::parse(pair.compare({"--json", "--block", "1"}).out);
    EXPECT_NEAR(numbers.at("relative_l1").get<double>(), 0.25, 1e-6);
    EXPECT_NEAR(numbers.at("mean_ratio").get<double>(), 1.25, 1e-6);
    EXPECT_NEAR(numbers.at("block_difference_max").get<double>(), 0.5, 1e-6);
}

TEST(CliCompare, EveryThresholdSpeaksForItself) {
    const Pair pair(1, 1.5f);
    const std::vector<std::pair<std::string, std::string>> thresholds{
        {"--max-relative-l1", "relative L1"}, {"--max-rmse", "RMSE"},
        {"--max-relmse", "relMSE"},           {"--max-flip", "FLIP"},
        {"--mean-tolerance", "mean ratio"},   {"--max-block", "worst block"}};
    std::vector<std::string> all{"--exposure", "-2"};  // FLIP cuts at 1
    for (const auto& [option, words] : thresholds) {
        EXPECT_EQ(pair.compare({option, "1"}).exit_code, 0);
        expect_one_line(pair.compare({option, "0.01", "--exposure", "-2"}), 1, words);
        expect_one_line(pair.compare({option, "-1"}), 2, option);
        all.insert(all.end(), {option, "0.01"});
    }
    EXPECT_EQ(line_count(pair.compare(all).err), thresholds.size());
}

TEST(CliCompare, PixelsThatAreNotFiniteNeverPass) {
    expect_one_line(Pair(1, std::numeric_limits<float>::quiet_NaN()).compare({}), 1, "not finite");
}

TEST(CliCompare, WritesTheDifference) {
    const Pair pair(1, 1.5f);
    EXPECT_EQ(pair.compare({"--difference", pair.folder / "d.png"}).exit_code, 0);
    EXPECT_EQ(read_image(pair.folder / "d.png").width, 2);
    expect_one_line(pair.compare({"--difference", "d.gif"}), 2, "--difference");
}

TEST(CliCompare, ReferenceOfBlockMeans) {
    const Pair pair(1, 1.05f);
    write_bytes(pair.folder / "se.pfm", pfm_of({0, 0, 0, 0.02f, 0.02f, 0.02f}));
    const std::vector<std::string> blocks{"--reference-blocks", "--relative", "0.01"};
    expect_one_line(pair.compare(blocks), 1, "blocks out of tolerance");
    std::vector<std::string> with_errors = blocks;
    with_errors.insert(with_errors.end(),
                       {"--reference-se", pair.folder / "se.pfm", "--sigmas", "3", "--json"});
    const CommandResult result = pair.compare(with_errors);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_TRUE(json::parse(result.out).at("passes"));
}

TEST(CliCompare, RefusesWhatDoesNotFit) {
    const Pair pair(1, 1);
    write_bytes(pair.folder / "broken.pfm", "PF\n2 1\n");
    expect_one_line(run_relumine({"compare", pair.image, pair.folder / "broken.pfm"}), 1, "broken.pfm");
    expect_one_line(run_relumine({"compare", pair.image, pair.folder / "nowhere.pfm"}), 1, "nowhere.pfm");
    expect_one_line(pair.compare({"--block", "0"}), 2, "0");
    expect_one_line(pair.compare({"--sigmas", "3"}), 2, "--reference-blocks");
    expect_one_line(pair.compare({"--reference-blocks", "--max-rmse", "1"}), 2, "--max-rmse");
}

}  // namespace
}  // namespace relumine::test
