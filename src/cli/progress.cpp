// SPDX-License-Identifier: Apache-2.0
// Progress as a bar and as JSON lines.
#include "cli/progress.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "cli/console.hpp"
#include "cli/report.hpp"

namespace relumine::cli {
namespace {

using Json = nlohmann::ordered_json;

double fraction_done(const Progress& progress) {
    if (progress.total == 0) return 0;
    return std::min(1.0, static_cast<double>(progress.done) / static_cast<double>(progress.total));
}

std::string bar(double fraction, int cells) {
    const auto full = static_cast<std::size_t>(fraction * cells);
    return std::string(full, '#') + std::string(static_cast<std::size_t>(cells) - full, '-');
}

}  // namespace

bool Pace::due() {
    const auto now = std::chrono::steady_clock::now();
    if (now - last_ < std::chrono::milliseconds(100)) return false;
    last_ = now;
    return true;
}

void ProgressBar::show(const Progress& progress) {
    const bool new_stage = progress.stage != stage_;
    if (!pace_.due() && !new_stage) return;
    stage_ = progress.stage;
    visible_ = true;
    const std::string line = fmt::format("\r{}\x1b[K", progress_text(progress, error_columns() - 1));
    std::fwrite(line.data(), 1, line.size(), stderr);
}

void ProgressBar::clear() {
    if (visible_) std::fputs("\r\x1b[K", stderr);
    visible_ = false;
}

void EventStream::send(const Json& event) const {
    if (enabled_) print(json_text(event) + "\n");
}

void EventStream::progress(const Progress& p) {
    const bool boundary = p.stage != stage_ || (p.total > 0 && p.done == p.total);
    if (!enabled_ || (!pace_.due() && !boundary)) return;
    stage_ = p.stage;
    send({{"event", "progress"},
          {"stage", p.stage},
          {"done", p.done},
          {"total", p.total},
          {"rays", p.rays},
          {"seconds", p.seconds},
          {"seconds_left", p.seconds_left < 0 ? Json() : Json(p.seconds_left)}});
}

void EventStream::tile(const PixelRect& pixels) {
    send({{"event", "tile"}, {"x0", pixels.x0}, {"y0", pixels.y0}, {"x1", pixels.x1}, {"y1", pixels.y1}});
}

void EventStream::warning(const std::string& text) { send({{"event", "warning"}, {"message", text}}); }

void EventStream::sample(const Json& sample) { send({{"event", "sample"}, {"sample", sample}}); }

void EventStream::finished(int exit_code, const Json& stats) {
    send({{"event", "finished"}, {"exit_code", exit_code}, {"stats", stats}});
}

void EventStream::error(const std::string& text, int exit_code) {
    send({{"event", "error"}, {"exit_code", exit_code}, {"message", text}});
}

std::string duration_text(double seconds) {
    const auto whole = static_cast<long long>(std::lround(std::clamp(seconds, 0.0, 1e9)));
    if (whole < 3600) return fmt::format("{}:{:02}", whole / 60, whole % 60);
    return fmt::format("{}:{:02}:{:02}", whole / 3600, whole / 60 % 60, whole % 60);
}

std::string progress_text(const Progress& p, int columns) {
    const double fraction = fraction_done(p);
    std::string text = fmt::format("{:<8}", p.stage);
    if (p.total > 0) text += fmt::format(" {:3.0f} % [{}]", std::floor(100 * fraction), bar(fraction, 24));
    if (p.rays > 0 && p.seconds > 0)
        text += fmt::format("  {:.2f} Mrays/s", static_cast<double>(p.rays) / p.seconds / 1e6);
    if (p.seconds_left >= 0) text += fmt::format("  {} left", duration_text(p.seconds_left));
    return text.substr(0, static_cast<std::size_t>(std::max(columns, 0)));
}

}  // namespace relumine::cli
