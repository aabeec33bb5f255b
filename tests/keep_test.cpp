// SPDX-License-Identifier: Apache-2.0
// Nothing is lost and nothing runs away: interrupted and resumed renders have the bits of uninterrupted ones,
// for every method, any number of threads, whole and cropped; limits hold.
#include <gtest/gtest.h>

#include <filesystem>
#include <limits>

#include "relumine/error.hpp"
#include "tests/keep_support.hpp"
#include "tests/run_command.hpp"

namespace relumine {
namespace {

using test::read_bytes;
using test::ScratchFolder;
using test::write_bytes;
using testing::no_end;
using testing::project_scene;
using testing::small_settings;
using testing::StopAfter;

void expect_same_picture(const Image& a, const Image& b) {
    ASSERT_EQ(a.layers.size(), b.layers.size());
    for (std::size_t i = 0; i < a.layers.size(); ++i)
        ASSERT_EQ(a.layers[i].pixels, b.layers[i].pixels) << "layer \"" << a.layers[i].name << "\"";
}

struct Outcome {
    Image image;
    RenderStats stats;
    int runs = 0;
};

/// Stops the render again and again, a little later each time, and goes on from its checkpoint.
Outcome render_in_pieces(const Scene& scene, const RenderSettings& settings, const std::string& file,
                         int step) {
    Outcome outcome;
    do {
        StopAfter observer(3 + step * ++outcome.runs);  // the first three reports begin stages
        RenderControl control;
        control.checkpoint = file;
        control.resume = outcome.runs > 1;
        control.checkpoint_interval = outcome.runs % 2;  // sometimes after every tile
        outcome.image = render(scene, settings, control, &observer);
        outcome.stats = observer.stats;
    } while (outcome.stats.stopped && outcome.runs < 200);
    return outcome;
}

class Interruption : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Methods, Interruption,
                         ::testing::Values("path", "gather", "reproject", "reproject-mc", "cache",
                                           "block-gather", "irradiance-cache", "radiance-cache"));

TEST_P(Interruption, NeitherItNorThreadsNorCropsChangeABit) {
    const Scene scene = project_scene("cornell-glossy.glb", "sky.exr");
    const ScratchFolder folder;
    for (const bool cropped : {false, true}) {
        RenderSettings settings = small_settings(GetParam());
        if (cropped) settings.crop = PixelRect{5, 3, 31, 18};
        settings.threads = 1;
        StopAfter observer(no_end);
        const Image uninterrupted = render(scene, settings, &observer);
        for (const int threads : {1, 2, 7}) {
            SCOPED_TRACE(std::to_string(threads) + (cropped ? " threads, cropped" : " threads"));
            settings.threads = threads;
            if (threads > 1) expect_same_picture(render(scene, settings), uninterrupted);
            const Outcome pieces = render_in_pieces(scene, settings, folder / "a.ckpt", 1 + threads % 3);
            std::filesystem::remove(folder / "a.ckpt");
            EXPECT_GT(pieces.runs, 1);
            expect_same_picture(pieces.image, uninterrupted);
            EXPECT_EQ(pieces.stats.rays, observer.stats.rays);  // each counted once
            EXPECT_EQ(pieces.stats.samples, observer.stats.samples);
            ASSERT_TRUE(pieces.stats.checkpoint);
            EXPECT_TRUE(pieces.stats.checkpoint->resumed);
            EXPECT_GT(pieces.stats.checkpoint->earlier_seconds, 0);
        }
    }
}

TEST(Interruption, TilesThatKeepRecordsOfTheirOwnResumeToo) {
    const Scene scene = project_scene("cornell-glossy.glb", "sky.exr");
    const ScratchFolder folder;
    RenderSettings settings = small_settings("reproject");
    settings.cache_scope = "tile";
    settings.width = 80;
    const Outcome pieces = render_in_pieces(scene, settings, folder / "a.ckpt", 1);
    EXPECT_GT(pieces.runs, 1);
    expect_same_picture(pieces.image, render(scene, settings));
}

TEST(Interruption, CacheMovesWithinAPassAndShowsWhatIsLit) {
    struct Watch : StopAfter {
        using StopAfter::StopAfter;
        void progress(const Progress& p) override {
            StopAfter::progress(p);
            if (p.stage == "render") done.push_back(p.done);
        }
        std::vector<std::uint64_t> done;
    };
    const Scene scene = project_scene("cornell-glossy.glb", "sky.exr");
    RenderSettings settings = small_settings("cache");
    settings.samples_per_pixel = 16;
    Watch whole(no_end);
    (void)render(scene, settings, &whole);
    ASSERT_GE(whole.done.size(), 3u);  // the beginning, two rows of cells, then tiles
    EXPECT_EQ(whole.done[0], 0u);
    EXPECT_EQ(whole.done[1], 36u * 20 * 16 * 16 / 20);
    EXPECT_EQ(whole.done.back(), 36u * 20 * 16);

    Watch first_row(4);  // "build", "lights", "render" begin, and one row is lit
    const Image image = render(scene, settings, &first_row);
    EXPECT_EQ(first_row.stats.samples, 36u * 16 * 16);
    for (int y : {0, 15, 16, 19})
        EXPECT_EQ(image.layer("samples")->pixels[static_cast<std::size_t>(y) * 36], y < 16 ? 16 : 0) << y;
    ASSERT_EQ(first_row.warnings.size(), 1u);  // half a picture must not surprise anybody
    EXPECT_EQ(first_row.warnings[0],
              "stopped in the first pass: 144 of 720 pixels have no sample and are black; --method path has "
              "samples everywhere sooner");
    EXPECT_TRUE(whole.warnings.empty());
}

// ---- checkpoints that do not fit

struct Begun {
    ScratchFolder folder;
    Scene scene = project_scene("cornell.glb");
    RenderSettings settings = small_settings("path");
    RenderControl control;

    Begun() {
        control.checkpoint = folder / "a.ckpt";
        StopAfter observer(7);
        (void)render(scene, settings, control, &observer);
        control.resume = true;
    }
    /// Why the checkpoint is refused for these; "" where it is not.
    [[nodiscard]] std::string refusal(const Scene& other, const RenderSettings& other_settings) const {
        try {
            StopAfter observer(4);
            (void)render(other, other_settings, control, &observer);
        } catch (const FileError& error) {
            return error.what();
        }
        return "";
    }
};

TEST(Checkpoints, OfOtherSettingsAreRefusedByName) {
    const Begun begun;
    const std::vector<std::pair<std::string, void (*)(RenderSettings&)>> changes{
        {"seed", [](RenderSettings& s) { s.seed = 9; }},
        {"method", [](RenderSettings& s) { s.method = "gather"; }},
        {"samples per pixel", [](RenderSettings& s) { s.samples_per_pixel = 6; }},
        {"max depth", [](RenderSettings& s) { s.max_depth = 3; }},
        {"width", [](RenderSettings& s) { s.width = 37; }},
        {"crop",
         [](RenderSettings& s) {
             s.crop = PixelRect{0, 0, 5, 5};
         }},
        {"aovs", [](RenderSettings& s) { s.aovs.pop_back(); }},
        {"masking", [](RenderSettings& s) { s.masking = "separable"; }}};
    for (const auto& [name, change] : changes) {
        RenderSettings other = begun.settings;
        change(other);
        EXPECT_NE(begun.refusal(begun.scene, other).find("a.ckpt: " + name + " of the checkpoint: expected"),
                  std::string::npos)
            << begun.refusal(begun.scene, other);
    }
    RenderSettings threads = begun.settings;
    threads.threads = 3;
    EXPECT_EQ(begun.refusal(begun.scene, threads), "");
}

TEST(Checkpoints, OfAnotherSceneAreRefusedByPart) {
    const Begun begun;
    EXPECT_NE(
        begun.refusal(project_scene("cornell-glossy.glb"), begun.settings).find("the scene's materials"),
        std::string::npos)
        << begun.refusal(project_scene("cornell-glossy.glb"), begun.settings);
    EXPECT_NE(begun.refusal(project_scene("cornell.glb", "sky.exr"), begun.settings)
                  .find("the scene's environment"),
              std::string::npos);
}

TEST(Checkpoints, DamagedOnesAreRefusedAndStay) {
    const Begun begun;
    const std::string whole = read_bytes(begun.control.checkpoint);
    for (const std::size_t size :
         {std::size_t{0}, std::size_t{7}, std::size_t{100}, whole.size() / 2, whole.size() - 1}) {
        write_bytes(begun.control.checkpoint, whole.substr(0, size));
        EXPECT_NE(begun.refusal(begun.scene, begun.settings).find("a.ckpt: expected"), std::string::npos);
        EXPECT_EQ(read_bytes(begun.control.checkpoint).size(), size);
    }
    std::string damaged = whole;
    damaged[whole.size() / 2] ^= 1;
    write_bytes(begun.control.checkpoint, damaged);
    EXPECT_NE(begun.refusal(begun.scene, begun.settings).find("an undamaged checkpoint"), std::string::npos);
    write_bytes(begun.control.checkpoint, whole);
    EXPECT_EQ(begun.refusal(begun.scene, begun.settings), "");
}

TEST(Checkpoints, AreNotOverwrittenUnasked) {
    Begun begun;
    begun.control.resume = false;
    EXPECT_THROW((void)render(begun.scene, begun.settings, begun.control), OutputError);
    begun.control.checkpoint = begun.folder.path().string();  // a folder
    EXPECT_THROW((void)render(begun.scene, begun.settings, begun.control), OutputError);
}

TEST(Checkpoints, FailingOnesDoNotEndTheRender) {
    Begun begun;
    std::filesystem::remove(begun.control.checkpoint);
    begun.control.checkpoint = begun.folder / "nowhere/a.ckpt";
    begun.control.checkpoint_interval = 0;
    StopAfter observer(no_end);
    expect_same_picture(render(begun.scene, begun.settings, begun.control, &observer),
                        render(begun.scene, begun.settings));
    ASSERT_EQ(observer.warnings.size(), 2u);  // none to resume, none written; the second once
    EXPECT_NE(observer.warnings[0].find("expected a checkpoint to go on from"), std::string::npos);
    EXPECT_NE(observer.warnings[1].find("a.ckpt"), std::string::npos);
    EXPECT_GT(observer.stats.checkpoint->failed, 1u);
    EXPECT_EQ(observer.stats.checkpoint->written, 0u);
}

// ---- limits

TEST(Limits, TimeIsUpWithThePictureSoFar) {
    RenderSettings settings = small_settings("path");
    settings.samples_per_pixel = 1 << 20;
    RenderControl control;
    control.time_limit = 0.3;
    StopAfter observer(no_end);
    const Image image = render(project_scene("cornell.glb"), settings, control, &observer);
    EXPECT_TRUE(observer.stats.stopped);
    EXPECT_EQ(observer.stats.stopped_by, "time limit");
    EXPECT_EQ(image.metadata.at("relumine.stopped_by"), "time limit");
    EXPECT_GT(observer.stats.samples, 0u);
    EXPECT_LT(observer.stats.total_seconds, 30);  // a busy machine may be late
    EXPECT_GT(testing::mean_of(image), 0);
}

TEST(Limits, ARenderThatIsDoneInTimeSaysNothingOfThem) {
    RenderControl control;
    control.time_limit = 1000;
    control.memory_limit = std::uint64_t{1} << 40;
    StopAfter observer(no_end);
    const Image image = render(project_scene("cornell.glb"), small_settings("path"), control, &observer);
    EXPECT_FALSE(observer.stats.stopped);
    EXPECT_EQ(image.metadata.count("relumine.stopped_by"), 0u);
}

std::string memory_message(const RenderSettings& settings, std::uint64_t limit) {
    RenderControl control;
    control.memory_limit = limit;
    try {
        StopAfter observer(5);
        (void)render(project_scene("cornell.glb"), settings, control, &observer);
    } catch (const Error& error) {
        return error.what();
    }
    return "";
}

TEST(Limits, WhatDoesNotFitIsRefusedWithTheNumberNeeded) {
    RenderSettings settings = small_settings("path");
    settings.aovs.clear();
    settings.width = settings.height = 30000;  // 900 million pixels × 2 × (3 floats and a count)
    const std::string message = memory_message(settings, std::uint64_t{8} << 30);
    EXPECT_NE(message.find("memory limit: expected at least "), std::string::npos) << message;
    EXPECT_NE(message.find("film 28800000000"), std::string::npos) << message;
    EXPECT_NE(message.find("picture 10800000000"), std::string::npos) << message;
}

TEST(Limits, MethodsTellWhatTheyHold) {
    for (const char* method : {"reproject", "cache", "irradiance-cache"}) {
        RenderSettings settings = small_settings(method);
        settings.aovs.clear();
        settings.width = settings.height = 4000;
        const std::string message = memory_message(settings, std::uint64_t{2} << 30);
        EXPECT_NE(message.find(std::string("method ") + method), std::string::npos) << message;
    }
}

TEST(Limits, WhereTheMethodIsTooLargeAnotherIsNamedThatFits) {
    RenderSettings settings = small_settings("cache");
    const std::string way_out = "; --method path needs ";
    const std::string message = memory_message(settings, std::uint64_t{30} << 20);
    const std::size_t found = message.find(way_out);
    ASSERT_NE(found, std::string::npos) << message;
    const std::uint64_t needed = std::stoull(message.substr(found + way_out.size()));
    settings.method = "path";
    EXPECT_EQ(memory_message(settings, needed).find("expected at least"), std::string::npos);
    EXPECT_NE(memory_message(settings, needed - 1).find("expected at least"), std::string::npos);
    EXPECT_EQ(memory_message(settings, needed - 1).find(way_out), std::string::npos);
}

TEST(Limits, ThatMayShowBelongToTheCheckpoint) {  // what does not fit is thinned, but not for `path`
    const test::ScratchFolder folder;
    for (const char* method : {"path", "cache"}) {
        RenderControl control;
        control.checkpoint = folder / method;
        const RenderSettings settings = small_settings(method);
        const Scene scene = project_scene("cornell.glb");
        StopAfter observer(3);
        (void)render(scene, settings, control, &observer);
        control.resume = true;
        control.memory_limit = std::uint64_t{1} << 40;
        std::string message;
        try {
            (void)render(scene, settings, control);
        } catch (const Error& error) {
            message = error.what();
        }
        EXPECT_EQ(message.find("memory limit") != std::string::npos, method == std::string("cache"))
            << message;
    }
}

TEST(Limits, WhatGrowsBeyondThemIsStopped) {
    const std::vector<char> held(std::size_t{64} << 20, 1);  // something else in the same process
    const std::string message = memory_message(small_settings("path"), std::uint64_t{40} << 20);
    EXPECT_NE(message.find("memory limit: expected at most 41943040 bytes in use, found "), std::string::npos)
        << message << held.back();
}

TEST(Limits, ValuesThatMakeNoSenseAreRefused) {
    for (const double bad :
         {-1.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
        RenderControl control;
        control.time_limit = bad;
        EXPECT_THROW(validate(control), SettingsError);
        control = {};
        control.checkpoint_interval = bad;
        EXPECT_THROW(validate(control), SettingsError);
    }
    RenderControl control;
    control.resume = true;
    EXPECT_THROW(validate(control), SettingsError);
}

}  // namespace
}  // namespace relumine
