// SPDX-License-Identifier: Apache-2.0
// How a render tells where it stands: a bar for people, JSON lines for programs.
#pragma once

#include <chrono>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "relumine/render.hpp"

namespace relumine::cli {

/// Says yes at most ten times a second.
class Pace {
  public:
    [[nodiscard]] bool due();

  private:
    std::chrono::steady_clock::time_point last_{};
};

/// One line on stderr that is overwritten in place: stage, %, Mrays/s, time left. Gone when it is destroyed.
class ProgressBar {
  public:
    ProgressBar() = default;
    ProgressBar(const ProgressBar&) = delete;
    ProgressBar& operator=(const ProgressBar&) = delete;
    ~ProgressBar() { clear(); }

    void show(const Progress& progress);
    void clear();

  private:
    Pace pace_;
    std::string stage_;
    bool visible_ = false;
};

/// One JSON object per line on stdout, or nothing at all if not enabled. The events: docs/command.md.
class EventStream {
  public:
    explicit EventStream(bool enabled) : enabled_(enabled) {}

    void progress(const Progress& progress);
    void tile(const PixelRect& pixels);
    void warning(const std::string& text);
    /// What `--only-sample` has found.
    void sample(const nlohmann::ordered_json& sample);
    void finished(int exit_code, const nlohmann::ordered_json& stats);
    void error(const std::string& text, int exit_code);

  private:
    void send(const nlohmann::ordered_json& event) const;

    bool enabled_;
    Pace pace_;
    std::string stage_;
};

/// What the bar says: "render   42 % [########------------]  12.3 Mrays/s  1:05 left", cut to `columns`.
[[nodiscard]] std::string progress_text(const Progress& progress, int columns);

/// "0:07", "12:34", "1:02:03".
[[nodiscard]] std::string duration_text(double seconds);

}  // namespace relumine::cli
