// SPDX-License-Identifier: Apache-2.0
// The command when things go wrong: killed, stopped, out of time, of memory or of disk; and what it says of
// single samples and of references.
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <iostream>
#include <nlohmann/json.hpp>
#include <optional>
#include <random>
#include <sstream>
#include <thread>

#include "cli_workplace.hpp"
#include "relumine/compare.hpp"
#include "relumine/image.hpp"

namespace relumine::test {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

const std::string first_tile = "\"event\":\"tile\"";

/// A folder with what belongs to one render that is to be interrupted.
struct Interrupted {
    ScratchFolder folder;
    std::string picture = folder / "out.pfm", checkpoint = folder / "out.ckpt", stats = folder / "stats.json";
    std::vector<std::string> job;  // scene, method, samples

    [[nodiscard]] CommandResult render(const std::vector<std::string>& more,
                                       const RunOptions& options = {}) const {
        std::vector<std::string> arguments{"render", "-o", picture, "--threads", "2"};
        arguments.insert(arguments.end(), job.begin(), job.end());
        arguments.insert(arguments.end(), more.begin(), more.end());
        return run_relumine(arguments, options);
    }
};

std::vector<std::string> job(const std::string& method, const std::string& samples, const std::string& size) {
    return {RELUMINE_SOURCE_DIR "/scenes/cornell.glb",
            "--method",
            method,
            "--spp",
            samples,
            "--size",
            size,
            "--record-size",
            "16",
            "--gap-cell",
            "8",
            "--radiance",
            "emission"};
}

using Clock = std::chrono::steady_clock;

int milliseconds_since(Clock::time_point begin) {
    return static_cast<int>(
        std::chrono::duration_cast<std::chrono::milliseconds>(Clock::now() - begin).count());
}

/// Begins a render and kills it at a moment between its beginning and its end. `whole`: how long it takes,
/// milliseconds; corrected where it was done before its moment came, and tried again.
void begin_and_kill(const Interrupted& work, const std::vector<std::string>& keep, std::mt19937& random,
                    int& whole) {
    for (int attempt = 0; attempt < 20; ++attempt) {
        RunOptions options;
        options.kill_after = std::uniform_int_distribution<int>(1, std::max(whole, 2))(random);
        const Clock::time_point begin = Clock::now();
        if (work.render(keep, options).exit_code == 128 + SIGKILL) return;
        whole = std::min(whole, milliseconds_since(begin));
    }
    FAIL() << "expected a render that can be killed, found one that is always done before";
}

/// Kills again and again; the picture of the resumed render must always be that of an uninterrupted one. How
/// many of `kills` found something to go on from.
int survive(const Interrupted& work, int kills, std::uint32_t seed) {
    const Clock::time_point begin = Clock::now();
    EXPECT_EQ(work.render({}).exit_code, 0);
    int whole = milliseconds_since(begin);
    const std::string expected = read_bytes(work.picture);
    std::mt19937 random(seed);
    int resumed = 0;
    const std::vector<std::string> keep{"--checkpoint", work.checkpoint, "--checkpoint-interval", "0.005"};
    std::vector<std::string> go_on = keep;
    go_on.insert(go_on.end(), {"--resume", "--stats", work.stats, "-q"});
    for (int i = 0; i < kills; ++i) {
        SCOPED_TRACE(i);
        begin_and_kill(work, keep, random, whole);
        fs::remove(work.picture);
        const CommandResult result = work.render(go_on);
        EXPECT_EQ(result.exit_code, 0) << result.err;
        EXPECT_TRUE(read_bytes(work.picture) == expected);
        const json stats = json::parse(read_bytes(work.stats));
        resumed += stats.at("checkpoint").at("resumed").get<bool>() ? 1 : 0;
        EXPECT_FALSE(fs::exists(work.checkpoint));
    }
    return resumed;
}

TEST(CliKilled, FiftyTimesAndNoBitIsLost) {
    struct Case {
        std::vector<std::string> job;
        int kills;
    };
    int resumed = 0, kills = 0;
    for (const Case& c : std::vector<Case>{{job("path", "600", "24x24"), 30},
                                           {job("reproject", "24", "12x12"), 10},
                                           {job("cache", "64", "8x8"), 10}}) {
        SCOPED_TRACE(c.job[2]);
        Interrupted work;
        work.job = c.job;
        resumed += survive(work, c.kills, 1 + static_cast<std::uint32_t>(kills));
        kills += c.kills;
    }
    RecordProperty("resumed", resumed);
    EXPECT_GT(resumed, kills / 5);  // the others were killed before anything was kept
    std::cout << "killed " << kills << " times, resumed " << resumed << " times\n";
}

TEST(CliStopped, EitherSignalKeepsACheckpointThatResumesToTheSameBits) {
    for (const int signal : {SIGINT, SIGTERM}) {
        Interrupted work;
        work.job = job("path", "3000", "24x24");
        RunOptions stop;
        stop.interrupt_when = first_tile;
        stop.signal = signal;
        const CommandResult stopped = work.render({"--checkpoint", work.checkpoint, "--json-events"}, stop);
        EXPECT_EQ(stopped.exit_code, 3) << stopped.err;
        EXPECT_TRUE(fs::exists(work.picture));
        EXPECT_TRUE(fs::exists(work.checkpoint));
        EXPECT_EQ(work.render({"--checkpoint", work.checkpoint, "--resume"}).exit_code, 0);
        EXPECT_FALSE(fs::exists(work.checkpoint));
        const std::string resumed = read_bytes(work.picture);
        EXPECT_EQ(work.render({}).exit_code, 0);
        EXPECT_TRUE(read_bytes(work.picture) == resumed);
    }
}

TEST(CliCheckpoint, BeginsAtTheBeginningWhereThereIsNone) {
    const Workplace work;
    const std::string checkpoint = work.folder / "a.ckpt";
    expect_one_line(work.render({"--checkpoint", checkpoint, "--resume"}), 0,
                    "expected a checkpoint to go on from, found none");
    expect_silent_success(work.render({"--checkpoint", checkpoint, "--resume", "-q"}));
    EXPECT_FALSE(fs::exists(checkpoint));
}

TEST(CliCheckpoint, IsRefusedBeforeTheWorkBegins) {
    const Workplace work;
    const std::string checkpoint = work.folder / "a.ckpt";
    expect_one_line(work.render({"--resume"}), 2, "--checkpoint");
    expect_one_line(work.render({"--checkpoint", work.folder / "no/a.ckpt"}), 1, "existing folder");
    expect_one_line(work.render({"--checkpoint", "/proc/a.ckpt"}), 1, "/proc");
    expect_one_line(work.render({"--checkpoint", "/dev/full"}), 1, "expected the name of a file");
    expect_one_line(work.render({"--checkpoint", work.folder.path().string()}), 1,
                    "expected the name of a file");
    write_bytes(checkpoint, "something");
    expect_one_line(work.render({"--checkpoint", checkpoint}), 1, "hours of work");
    expect_one_line(work.render({"--checkpoint", checkpoint, "--resume"}), 1, "found something else");
    EXPECT_EQ(read_bytes(checkpoint), "something");
    EXPECT_FALSE(fs::exists(work.picture));
}

TEST(CliCheckpoint, FullDiskCostsTheCheckpointsAlone) {
    const Workplace work;
    RunOptions full_disk;
    full_disk.file_limit = 8000;  // bytes: enough for these pictures, not for the film
    const CommandResult result =
        work.render({"-o", work.folder / "a.png", "--checkpoint", work.folder / "a.ckpt",
                     "--checkpoint-interval", "0", "--spp", "8", "--size", "32x32"},
                    full_disk);
    EXPECT_EQ(result.exit_code, 0);
    EXPECT_NE(result.err.find("a.ckpt: cannot write"), std::string::npos) << result.err;
    EXPECT_NE(result.err.find("goes on without"), std::string::npos) << result.err;
    EXPECT_FALSE(fs::exists(work.folder / "a.ckpt"));
    EXPECT_FALSE(fs::exists(work.folder / "a.ckpt.unfinished"));
    EXPECT_EQ(read_image(work.folder / "a.png").width, 32);
}

TEST(CliCheckpoint, StaysWhereThePictureCannotBeWritten) {
    Interrupted work;
    work.job = job("path", "2000", "24x24");
    work.picture = work.folder / "sub/out.pfm";
    fs::create_directory(work.folder / "sub");
    CommandResult result;
    {
        const std::jthread vandal([&] {
            while (!fs::exists(work.checkpoint)) std::this_thread::sleep_for(std::chrono::milliseconds(1));
            fs::remove_all(work.folder / "sub");
        });
        result = work.render({"--checkpoint", work.checkpoint, "--checkpoint-interval", "0.001"});
    }
    expect_one_line(result, 1, "out.pfm: cannot create");
    EXPECT_TRUE(fs::exists(work.checkpoint));
    fs::create_directory(work.folder / "sub");
    EXPECT_EQ(work.render({"--checkpoint", work.checkpoint, "--resume", "--stats", work.stats}).exit_code, 0);
    EXPECT_EQ(json::parse(read_bytes(work.stats)).at("checkpoint").at("resumed_samples"), 24 * 24 * 2000);
    EXPECT_TRUE(fs::exists(work.picture));
    EXPECT_FALSE(fs::exists(work.checkpoint));
}

// ---- limits

TEST(CliLimits, TimeIsUpWithThePictureSoFarAndExitCode0) {
    const Workplace work;
    const CommandResult result = work.render({"--method", "path", "--spp", "500000", "--time-limit", "0.5",
                                              "--stats", work.folder / "stats.json"});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    const json stats = json::parse(read_bytes(work.folder / "stats.json"));
    EXPECT_EQ(stats.at("stopped_by"), "time limit");
    EXPECT_GT(stats.at("samples"), 0);
    const Image image = read_image(work.picture);
    EXPECT_EQ(image.metadata.at("relumine.stopped_by"), "time limit");
    EXPECT_NEAR(image.rgb(8, 8)[1], 1, 1e-5);
}

TEST(CliLimits, MemoryThatDoesNotSufficeIsRefusedWithTheNumberNeeded) {
    const Workplace work;
    expect_one_line(work.render({"--size", "20000x20000", "--memory-limit", "1G"}), 1,
                    "memory limit: expected at least ");
    expect_silent_success(work.render({"--memory-limit", "4G"}));
}

TEST(CliLimits, BadValuesAreBadUsage) {
    const Workplace work;
    for (const char* value : {"", "G", "0", "-1", "4X", "1.5G", "99999999999999999999", "99999999T"})
        expect_one_line(work.render({"--memory-limit", value}), 2, "--memory-limit: expected");
    for (const char* value : {"-1", "nan", "x"})
        expect_one_line(work.render({"--time-limit", value}), 2, "time");
    expect_one_line(work.render({"--checkpoint-interval", "-1"}), 2, "checkpoint interval");
    expect_one_line(work.render({"--isa", "avx"}), 2, "instruction set: expected");
    for (const char* value : {"1,2", "1,2,3,4", "a,b,c", "1,2,-1"})
        expect_one_line(work.render({"--only-sample", value}), 2, "--only-sample: expected");
    expect_one_line(work.render({"--only-sample", "16,0,0"}), 2, "pixel: expected 0,0 to 15,15, found 16,0");
    expect_one_line(work.render({"--only-sample", "0,0,1"}), 2, "sample: expected 0 to 0, found 1");
}

// ---- single samples

/// The square of the scene, as bright as a float can be: no sum of its samples is finite.
json poisoned() {
    json gltf = tiny_gltf();
    gltf["extensionsUsed"] = {"KHR_materials_emissive_strength"};
    gltf["materials"][0]["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"] = 3.2e38;
    return gltf;
}

TEST(CliNonFinite, IsWarnedOfWithTheCommandThatReplaysIt) {
    const Workplace work;
    write_bytes(work.scene, poisoned().dump());
    const CommandResult result = work.render({"--spp", "2"});
    expect_one_line(result, 0, "512 of 512 samples were not finite");
    const std::size_t begin = result.err.find("relumine render ");
    ASSERT_NE(begin, std::string::npos) << result.err;
    std::istringstream words(result.err.substr(begin));
    std::vector<std::string> command;
    for (std::string word; words >> word;) command.push_back(word);
    command.erase(command.begin());  // "relumine"
    EXPECT_EQ(command[command.size() - 2], "--only-sample");
    fs::remove(work.picture);
    const CommandResult replayed = run_relumine(command);
    EXPECT_EQ(replayed.exit_code, 0) << replayed.err;
    EXPECT_NE(replayed.out.find("pixel 0,0 sample 0: not finite"), std::string::npos) << replayed.out;
    EXPECT_NE(replayed.out.find("radiance   3.2e+38"), std::string::npos) << replayed.out;
    EXPECT_FALSE(fs::exists(work.picture));
}

TEST(CliNonFinite, HealthySamplesAreToldToo) {
    const Workplace work;
    const CommandResult text = work.render({"--only-sample", "3,4,0"});
    EXPECT_EQ(text.out.substr(0, text.out.find('\n')), "pixel 3,4 sample 0: finite");
    const json event = json::parse(work.render({"--only-sample", "3,4,0", "--json-events"}).out);
    EXPECT_EQ(event.at("event"), "sample");
    EXPECT_TRUE(event.at("sample").at("finite"));
    EXPECT_EQ(event.at("sample").at("radiance"), (json{1.0, 1.0, 1.0}));
}

// ---- references

TEST(CliReference, TellsTheTrueError) {
    const Workplace work;
    expect_silent_success(work.render({"-o", work.folder / "truth.pfm"}));
    const std::string stats = work.folder / "stats.json";
    const auto error_of = [&](const std::vector<std::string>& more) {
        std::vector<std::string> arguments{"--reference", work.folder / "truth.pfm", "--stats", stats};
        arguments.insert(arguments.end(), more.begin(), more.end());
        expect_silent_success(work.render(arguments));
        return json::parse(read_bytes(stats)).at("reference").at("relative_l1").get<double>();
    };
    EXPECT_EQ(error_of({}), 0);
    EXPECT_EQ(error_of({"--crop", "4", "2", "12", "6"}), 0);  // a reference of the full frame is cut
    Image brighter = read_image(work.folder / "truth.pfm");
    for (float& value : brighter.layers[0].pixels) value *= 1.25f;
    write_image(brighter, work.folder / "truth.pfm");
    EXPECT_NEAR(error_of({}), 0.2, 1e-5);
}

TEST(CliReference, ThatDoesNotFitIsRefusedBeforeTheWork) {
    const Workplace work;
    write_bytes(work.folder / "small.pfm", pfm_of({1, 1, 1, 1, 1, 1}));
    expect_one_line(work.render({"--reference", work.folder / "small.pfm"}), 1,
                    "expected a reference of 16 x 16 pixels, found 2 x 1");
    expect_one_line(work.render({"--reference", work.folder / "none.pfm"}), 1, "none.pfm");
    EXPECT_FALSE(fs::exists(work.picture));
}

TEST(CliReference, ShowsOnTheClosingLine) {
    if (!terminals_available()) GTEST_SKIP() << "expected pseudo-terminals, found none on this machine";
    const Workplace work;
    expect_silent_success(work.render({"-o", work.folder / "truth.pfm"}));
    RunOptions terminal;
    terminal.terminal = true;
    const CommandResult result = work.render({"--reference", work.folder / "truth.pfm"}, terminal);
    EXPECT_NE(result.err.find("relative L1 0"), std::string::npos) << result.err;
}

// ---- instruction sets

TEST(CliIsa, PinsTheSetAndItStandsInTheCheckpoint) {
    Interrupted work;
    work.job = job("path", "3000", "24x24");
    RunOptions stop;
    stop.interrupt_when = first_tile;
    if (work.render({"--isa", "sse4", "--only-sample", "0,0,0"}).exit_code != 0)
        GTEST_SKIP() << "no x86 here";
    (void)work.render({"--isa", "sse4", "--checkpoint", work.checkpoint, "--json-events"}, stop);
    if (work.render({"--isa", "avx2", "--only-sample", "0,0,0"}).exit_code != 0)
        GTEST_SKIP() << "one instruction set alone";
    expect_one_line(work.render({"--isa", "avx2", "--checkpoint", work.checkpoint, "--resume"}), 1,
                    "instruction set of the checkpoint: expected \"AVX2\" as in this render, found \"SSE4\"");
}

/// What docs/command.md promises between instruction sets: the relative L1 of two pictures.
double isa_bound(const std::string& method) { return method == "cache" ? 2e-3 : 1e-4; }

class IsaMethods : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Cli, IsaMethods,
                         ::testing::Values("path", "gather", "reproject", "reproject-mc", "cache",
                                           "block-gather", "irradiance-cache", "radiance-cache"));

TEST_P(IsaMethods, PicturesStayWithinTheBound) {
    const ScratchFolder folder;
    const auto render = [&](const std::string& isa, const std::string& seed) {
        const std::string file = folder / (isa + seed + ".pfm");
        const int code = run_relumine({"render",
                                       RELUMINE_SOURCE_DIR "/scenes/cornell-glossy.glb",
                                       "--environment",
                                       RELUMINE_SOURCE_DIR "/scenes/sky.exr",
                                       "--method",
                                       GetParam(),
                                       "--isa",
                                       isa,
                                       "--seed",
                                       seed,
                                       "--size",
                                       "36x20",
                                       "--spp",
                                       "2",
                                       "--max-depth",
                                       "4",
                                       "--record-size",
                                       "16",
                                       "--gap-cell",
                                       "8",
                                       "--gather-rays",
                                       "16",
                                       "--radiance",
                                       "emission",
                                       "-o",
                                       file})
                             .exit_code;
        return code == 0 ? std::optional(read_image(file)) : std::nullopt;
    };
    const std::optional<Image> reference = render("sse4", "0");
    if (!reference) GTEST_SKIP() << "no x86 here";
    const double bound = isa_bound(GetParam());
    for (const char* isa : {"avx2", "avx512"})
        if (const std::optional<Image> image = render(isa, "0")) {
            EXPECT_LE(compare_images(*image, *reference, {}).relative_l1, bound) << isa;
        }
    EXPECT_GT(compare_images(*render("sse4", "1"), *reference, {}).relative_l1, bound);  // other rays
}

}  // namespace
}  // namespace relumine::test
