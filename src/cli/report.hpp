// SPDX-License-Identifier: Apache-2.0
// Scenes, settings and statistics in words and as JSON.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "cli/render_options.hpp"
#include "relumine/render.hpp"
#include "relumine/scene.hpp"

namespace relumine::cli {

/// On one line, or indented; bytes that are not UTF-8 are replaced.
[[nodiscard]] std::string json_text(const nlohmann::ordered_json& json, int indent = -1);

/// The scene's numbers; keys: docs/statistics.md.
[[nodiscard]] nlohmann::ordered_json scene_json(const std::string& file, const SceneInfo& info);

/// What `info` prints for people. Several lines.
[[nodiscard]] std::string scene_text(const std::string& file, const SceneInfo& info);

/// All of `--stats`; keys: docs/statistics.md.
[[nodiscard]] nlohmann::ordered_json stats_json(const std::string& command_line, const RenderOptions& options,
                                                const SceneInfo& info, const Image& image,
                                                const RenderStats& stats);

/// What one camera sample has brought, for programs and for people (several lines).
[[nodiscard]] nlohmann::ordered_json sample_json(const OnlySample& which, const ReplayedSample& sample);
[[nodiscard]] std::string sample_text(const OnlySample& which, const ReplayedSample& sample);

/// "1.5 MB"; powers of 1000.
[[nodiscard]] std::string bytes_text(double bytes);

}  // namespace relumine::cli
