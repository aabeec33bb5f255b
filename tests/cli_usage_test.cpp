// SPDX-License-Identifier: Apache-2.0
// Arguments of the command: help, what is refused, and in which words.
#include <gtest/gtest.h>

#include <filesystem>

#include "cli_workplace.hpp"
#include "relumine/render.hpp"

namespace relumine::test {
namespace {

TEST(Cli, TellsItsVersion) {
    const CommandResult result = run_relumine({"--version"});
    EXPECT_EQ(result.exit_code, 0);
    EXPECT_EQ(result.out, std::string("relumine ") + version() + "\n");
}

TEST(Cli, HelpNamesEveryCommand) {
    const CommandResult result = run_relumine({"--help"});
    EXPECT_EQ(result.exit_code, 0);
    for (const char* command : {"render", "info", "compare", "inspect"})
        EXPECT_NE(result.out.find(command), std::string::npos);
    for (const char* command : {"render", "info", "compare", "inspect"})
        EXPECT_EQ(run_relumine({command, "--help"}).exit_code, 0);
}

TEST(Cli, HelpNamesEveryOptionAndItsDefault) {
    const std::string help = run_relumine({"render", "--help"}).out;
    for (const char* option : {"--output",
                               "--method",
                               "--spp",
                               "--pixel-sampling",
                               "--pixel-filter",
                               "--sampler",
                               "--gather-rays",
                               "--light-samples",
                               "--max-depth",
                               "--radiance",
                               "--guide",
                               "--masking",
                               "--allow-dir",
                               "--environment",
                               "--env-scale",
                               "--env-rotate",
                               "--camera",
                               "--size",
                               "--crop",
                               "--exposure",
                               "--threads",
                               "--seed",
                               "--aov",
                               "--half",
                               "--stats",
                               "--json-events",
                               "--quiet",
                               "--no-progress",
                               "--gather-packets",
                               "--record-size",
                               "--record-layers",
                               "--record-spacing",
                               "--records-per-point",
                               "--gap-cell",
                               "--bsdf-share",
                               "--cache-scope",
                               "--error",
                               "--unbiased",
                               "--filter-residual",
                               "--residual-rays",
                               "--without",
                               "--accuracy",
                               "--glossy-rays",
                               "--harmonics",
                               "--time-limit",
                               "--memory-limit",
                               "--texture-limit",
                               "--checkpoint",
                               "--checkpoint-interval",
                               "--resume",
                               "--only-sample",
                               "--isa",
                               "--reference",
                               "(default cache)",
                               "(default 16)",
                               "(default 4096)",
                               "(default box)"})
        EXPECT_NE(help.find(option), std::string::npos) << option;
}

struct Usage {
    std::vector<std::string> arguments;
    std::string words;  // of the one line on stderr
};

TEST(Cli, RefusesWhatDoesNotExistYetByName) {
    const Workplace work;
    for (const char* option : {"--preview", "--denoise", "--tev"})
        expect_one_line(work.render({option, "1"}), 2,
                        std::string(option) + " is not available yet: it comes with ");
    for (const Usage& usage : std::vector<Usage>{{{"--tev=localhost:14158"}, "--tev is not available yet"},
                                                 {{"--radiance", "photons"}, "--radiance photons is not"}})
        expect_one_line(work.render(usage.arguments), 2, usage.words);
    expect_one_line(run_relumine({"relight"}), 2, "relight is not available yet");
}

TEST(Cli, RefusesBadUsage) {
    const std::vector<Usage> cases{
        {{}, "expected a command"},
        {{"rendr", "a.glb"}, "did you mean \"render\"?"},
        {{"render"}, "SCENE"},
        {{"render", "a.glb"}, "--output"},
        {{"render", "a.glb", "-o"}, "--output"},
        {{"render", "a.glb", "b.glb", "-o", "c.png"}, "b.glb"},
        {{"render", "a.glb", "-o", "c.jpg"}, ".exr, .png or .pfm"},
        {{"render", "a.glb", "-o", "c"}, ".exr, .png or .pfm"},
        {{"render", "a.glb", "-o", "c.png", "-o", "c.png"}, "once"},
        {{"render", "a.glb", "-o", "c.png", "--sppp", "4"}, "did you mean \"--spp\"?"},
        {{"render", "a.glb", "-o", "c.png", "--json-events", "--stats", "-"}, "--stats"},
        {{"inspect"}, "SCENE"},
        {{"inspct"}, "did you mean \"inspect\"?"},
        {{"info"}, "SCENE"},
        {{"info", "a.glb", "--jsn"}, "did you mean \"--json\"?"},
        {{"compare", "a.png"}, "REFERENCE"},
    };
    for (const Usage& usage : cases) expect_one_line(run_relumine(usage.arguments), 2, usage.words);
}

TEST(Cli, RefusesSettingsOutOfRange) {
    const std::vector<Usage> cases{
        {{"--spp", "0"}, "found 0"},
        {{"--spp", "-1"}, "found -1"},
        {{"--spp", "2x"}, "--spp: expected a whole number"},
        {{"--spp", "1.5"}, "--spp: expected a whole number"},
        {{"--spp", ""}, "--spp: expected a whole number"},
        {{"--spp", "99999999999"}, "--spp: expected a whole number"},
        {{"--spp", "1", "--spp", "2"}, "--spp"},
        {{"--size", "16"}, "--size: expected WIDTHxHEIGHT"},
        {{"--size", "16x"}, "--size: expected WIDTHxHEIGHT"},
        {{"--size", "x16"}, "--size: expected WIDTHxHEIGHT"},
        {{"--size", "0x16"}, "--size: expected WIDTHxHEIGHT"},
        {{"--size", "-4x16"}, "--size: expected WIDTHxHEIGHT"},
        {{"--size", "1e3x16"}, "--size: expected WIDTHxHEIGHT"},
        {{"--size", "2000000000x2000000000"}, "2000000000"},
        {{"--crop", "0", "0", "0", "16"}, "crop"},
        {{"--crop", "8", "8", "4", "4"}, "crop"},
        {{"--crop", "0", "0", "17", "16"}, "17"},
        {{"--crop", "-1", "0", "4", "4"}, "-1"},
        {{"--crop", "0", "0", "4", "x"}, "--crop"},
        {{"--crop", "0", "0", "4"}, "--crop"},
        {{"--threads", "-1"}, "-1"},
        {{"--threads", "two"}, "--threads"},
        {{"--seed", "-1"}, "--seed: expected a whole number from 0"},
        {{"--seed", "18446744073709551616"}, "--seed: expected a whole number"},
        {{"--gather-rays", "0", "--method", "gather"}, "found 0"},
        {{"--light-samples", "-2", "--method", "gather"}, "found -2"},
        {{"--max-depth", "-2"}, "found -2"},
        {{"--exposure", "nan"}, "--exposure: expected a finite number"},
        {{"--env-rotate", "x"}, "--env-rotate: expected a finite number"},
        {{"--env-scale", "inf"}, "--env-scale: expected a finite number"},
        {{"--env-scale", "-1"}, "-1"},
        {{"--method", "pth"}, "did you mean \"path\"?"},
        {{"--sampler", "sobl"}, "sobol"},
        {{"--radiance", "emision", "--method", "gather"}, "emission"},
        {{"--masking", "none"}, "none"},
        {{"--guide", "photons"}, "guide"},
        {{"--pixel-sampling", "centre"}, "center"},
        {{"--pixel-filter", "bx"}, "box"},
        {{"--gather-packets", "maybe"}, "--gather-packets: expected on or off, found \"maybe\""},
        {{"--record-size", "48"}, "record size: expected one of 16, 32, 64, 128, found 48"},
        {{"--record-size", "64x64"}, "--record-size: expected a whole number"},
        {{"--record-layers", "0"}, "record layers: expected 1 to 64, found 0"},
        {{"--record-layers", "65"}, "found 65"},
        {{"--record-spacing", "0"}, "record spacing: expected 0.01 to 100, found 0"},
        {{"--record-spacing", "101"}, "found 101"},
        {{"--record-spacing", "nan"}, "--record-spacing: expected a finite number"},
        {{"--records-per-point", "0"}, "records per point: expected 1 to 16, found 0"},
        {{"--records-per-point", "17"}, "found 17"},
        {{"--gap-cell", "3"}, "gap cell: expected one of 1, 2, 4, 8, found 3"},
        {{"--gap-cell", "16"}, "found 16"},
        {{"--bsdf-share", "2"}, "BSDF share: expected 0 to 1, found 2"},
        {{"--bsdf-share", "-0.1"}, "found -0.1"},
        {{"--bsdf-share", "x"}, "--bsdf-share: expected a finite number"},
        {{"--error", "0"}, "error: expected 0.0005 to 0.5, found 0"},
        {{"--error", "0.0004"}, "error: expected 0.0005 to 0.5, found 0.0004"},
        {{"--error", "0.6"}, "error: expected 0.0005 to 0.5, found 0.6"},
        {{"--error", "nan"}, "--error: expected a finite number"},
        {{"--error", "2%"}, "--error: expected a finite number"},
        {{"--residual-rays", "-2"}, "residual rays: expected -1 to 1048576, found -2"},
        {{"--residual-rays", "1048577"}, "found 1048577"},
        {{"--residual-rays", "1.5"}, "--residual-rays: expected a whole number"},
        {{"--filter-residual", "maybe"}, "--filter-residual: expected on or off, found \"maybe\""},
        {{"--without", "blendin"}, "did you mean \"blending\"?"},
        {{"--without", "splits,splits"}, "without: expected each part once, found \"splits\" twice"},
        {{"--light-samples", "-2", "--method", "cache"}, "found -2"},
        {{"--method", "cach"}, "did you mean \"cache\"?"},
        {{"--cache-scope", "x"}, "cache scope: expected image or tile, found \"x\""},
        {{"--cache-scope", "til"}, "did you mean \"tile\"?"},
        {{"--method", "reproject-mcc"}, "did you mean \"reproject-mc\"?"},
        {{"--aov", "recrods"}, "did you mean \"records\"?"},
        {{"--aov", "albdo"}, "did you mean \"albedo\"?"},
        {{"--aov", "albedo,"}, ""},
        {{"--camera", "nobody"}, "nobody"},
        {{"--camera", "7"}, "7"},
    };
    const Workplace work;
    for (const Usage& usage : cases) {
        SCOPED_TRACE(usage.arguments[0] + " " + usage.arguments[1]);
        expect_one_line(work.render(usage.arguments), 2, usage.words);
        EXPECT_FALSE(std::filesystem::exists(work.picture));
    }
}

}  // namespace
}  // namespace relumine::test
