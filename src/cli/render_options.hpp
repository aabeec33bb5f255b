// SPDX-License-Identifier: Apache-2.0
// The options of `relumine render`, and those of them that other commands share.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "cli/arguments.hpp"
#include "relumine/image.hpp"
#include "relumine/render.hpp"
#include "relumine/scene.hpp"

namespace relumine::cli {

/// One camera sample: pixel of the full frame, number of the sample.
struct OnlySample {
    int x = 0, y = 0;
    std::uint32_t sample = 0;
};

struct RenderOptions {
    std::string scene;
    std::vector<std::string> outputs;  // at least one
    SceneOptions scene_options;
    RenderSettings settings;
    WriteOptions write;
    RenderControl control;
    std::string instruction_set;            // "": the machine's best
    std::optional<OnlySample> only_sample;  // instead of the picture
    std::string reference;                  // picture to compare with; "": none
    std::string stats_file;                 // "": none; "-": stdout
    bool json_events = false;
    bool quiet = false;
    bool no_progress = false;
};

void add_record_options(CLI::App& app, RenderSettings& settings);
void add_light_options(CLI::App& app, RenderSettings& settings);
void add_environment_options(CLI::App& app, SceneOptions& scene);
void add_access_options(CLI::App& app, SceneOptions& scene);
void add_frame_options(CLI::App& app, RenderSettings& settings);

/// Empty when help was wanted and has been printed. Throws UsageError.
[[nodiscard]] std::optional<RenderOptions> parse_render_options(const Arguments& arguments);

}  // namespace relumine::cli
