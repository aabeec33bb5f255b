// SPDX-License-Identifier: Apache-2.0
// `relumine render`: a scene file becomes pictures.
#include <fmt/format.h>

#include <exception>
#include <nlohmann/json.hpp>

#include "cli/command.hpp"
#include "cli/console.hpp"
#include "cli/interrupt.hpp"
#include "cli/outputs.hpp"
#include "cli/progress.hpp"
#include "cli/render_options.hpp"
#include "cli/report.hpp"
#include "relumine/error.hpp"

namespace relumine::cli {
namespace {

/// Passes progress on to whoever wants it, and the first Ctrl-C to the render.
class Reporter : public RenderObserver {
  public:
    Reporter(ProgressBar* bar, EventStream& events) : bar_(bar), events_(events) {}

    void progress(const Progress& p) override {
        if (bar_) bar_->show(p);
        events_.progress(p);
    }
    void tile_finished(const PixelRect& pixels) override { events_.tile(pixels); }
    bool stop_requested() override { return interrupted(); }
    void finished(const RenderStats& stats) override { stats_ = stats; }

    [[nodiscard]] const RenderStats& stats() const { return stats_; }

  private:
    ProgressBar* bar_;  // null: nobody watches
    EventStream& events_;
    RenderStats stats_;
};

struct Rendered {
    Image image;
    RenderStats stats;
};

std::string command_line(const Arguments& arguments) {
    std::string line = "relumine render";
    for (const std::string& argument : arguments) line += " " + quote_for_shell(argument);
    return line;
}

void warn(const std::string& text, const RenderOptions& options, EventStream& events) {
    if (!options.quiet) print_line("relumine: warning: " + text);
    events.warning(text);
}

/// Everything that can be known to fail before the work begins.
void check_before_work(const RenderOptions& options) {
    validate(options.settings);
    check_pictures("--output", options.outputs);
    if (!options.stats_file.empty() && options.stats_file != "-") check_writable(options.stats_file);
}

Rendered render_watched(const Scene& scene, const RenderOptions& options, EventStream& events) {
    ProgressBar bar;
    const bool watched = error_is_terminal() && !options.quiet && !options.no_progress;
    Reporter reporter(watched ? &bar : nullptr, events);
    catch_first_interrupt();
    Image image = render(scene, options.settings, &reporter);
    return {std::move(image), reporter.stats()};
}

void warn_of_lost_samples(const RenderStats& stats, const RenderOptions& options, EventStream& events) {
    if (stats.non_finite_rays > 0)
        warn(fmt::format("{} rays of records and gaps were not finite and count as black",
                         stats.non_finite_rays),
             options, events);
    if (stats.non_finite_samples == 0) return;
    std::string text = fmt::format("{} of {} samples were not finite and are left out",
                                   stats.non_finite_samples, stats.samples);
    if (const auto& first = stats.first_non_finite)
        text += fmt::format("; the first: pixel {},{} sample {}", (*first)[0], (*first)[1], (*first)[2]);
    warn(text, options, events);
}

/// Tries every output, so that one full disk does not cost the others; then throws the first failure.
void save(const Image& image, const RenderOptions& options) {
    std::exception_ptr first_failure;
    for (const std::string& path : options.outputs) {
        try {
            write_image(image, path, options.write);
        } catch (...) {
            if (!first_failure) first_failure = std::current_exception();
        }
    }
    if (first_failure) std::rethrow_exception(first_failure);
}

/// What a person at a terminal wants to know at the end; nothing where nobody watches.
void print_summary(const Rendered& rendered, const RenderOptions& options) {
    if (options.quiet || options.no_progress || !error_is_terminal()) return;
    const RenderStats& stats = rendered.stats;
    print_line(fmt::format("{}{}: {} x {} pixels, {} samples, {:.2f} s, {:.2f} Mrays/s, {}",
                           stats.stopped ? "stopped; wrote " : "", options.outputs.front(),
                           rendered.image.width, rendered.image.height, stats.samples, stats.total_seconds,
                           static_cast<double>(stats.total_rays) / std::max(stats.total_seconds, 1e-9) / 1e6,
                           bytes_text(static_cast<double>(stats.peak_memory_bytes))));
}

ExitCode render_to_files(const RenderOptions& options, const std::string& command, EventStream& events) {
    check_before_work(options);
    const Scene scene = load_scene(options.scene, options.scene_options);
    const SceneInfo info = scene.info();
    for (const std::string& warning : info.warnings) warn(warning, options, events);

    Rendered rendered = render_watched(scene, options, events);
    if (rendered.stats.stopped && rendered.stats.samples == 0)
        throw Error(fmt::format(
            "{}: expected at least one sample per pixel, found a signal before it; nothing is written",
            options.outputs.front()));
    warn_of_lost_samples(rendered.stats, options, events);

    rendered.image.metadata["relumine.command"] = command;
    save(rendered.image, options);
    const ExitCode code = rendered.stats.stopped ? ExitCode::stopped : ExitCode::done;
    const nlohmann::ordered_json stats = stats_json(command, options, info, rendered.image, rendered.stats);
    if (!options.stats_file.empty()) write_text(options.stats_file, json_text(stats, 2) + "\n");
    events.finished(static_cast<int>(code), stats);
    print_summary(rendered, options);
    return code;
}

}  // namespace

ExitCode run_render(const Arguments& arguments) {
    const std::optional<RenderOptions> options = parse_render_options(arguments);
    if (!options) return ExitCode::done;
    EventStream events(options->json_events);
    try {
        return render_to_files(*options, command_line(arguments), events);
    } catch (const std::exception& error) {
        events.error(line_of(error), static_cast<int>(exit_code_of(error)));
        throw;
    }
}

}  // namespace relumine::cli
