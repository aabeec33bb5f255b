// SPDX-License-Identifier: Apache-2.0
// `relumine render`: a scene file becomes pictures.
#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <exception>
#include <nlohmann/json.hpp>

#include "cli/command.hpp"
#include "cli/console.hpp"
#include "cli/interrupt.hpp"
#include "cli/outputs.hpp"
#include "cli/progress.hpp"
#include "cli/reference.hpp"
#include "cli/render_options.hpp"
#include "cli/report.hpp"
#include "relumine/compare.hpp"
#include "relumine/error.hpp"

namespace relumine::cli {
namespace {

/// Passes progress on to whoever wants it, and the first Ctrl-C to the render.
class Reporter : public RenderObserver {
  public:
    Reporter(ProgressBar* bar, bool quiet, EventStream& events) : bar_(bar), quiet_(quiet), events_(events) {}

    void progress(const Progress& p) override {
        if (bar_) bar_->show(p);
        events_.progress(p);
    }
    void tile_finished(const PixelRect& pixels) override { events_.tile(pixels); }
    bool stop_requested() override { return interrupted(); }
    void warning(const std::string& text) override {
        if (bar_) bar_->clear();
        if (!quiet_) print_line("relumine: warning: " + text);
        events_.warning(text);
    }
    void finished(const RenderStats& stats) override { stats_ = stats; }

    [[nodiscard]] const RenderStats& stats() const { return stats_; }

  private:
    ProgressBar* bar_;  // null: nobody watches
    bool quiet_;
    EventStream& events_;
    RenderStats stats_;
};

struct Rendered {
    Image image;
    RenderStats stats;
    std::optional<Comparison> error;  // against --reference
};

using Clock = std::chrono::steady_clock;

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
    validate(options.control);
    check_pictures("--output", options.outputs);
    if (!options.control.checkpoint.empty()) check_writable(options.control.checkpoint);
    if (!options.stats_file.empty() && options.stats_file != "-") check_writable(options.stats_file);
}

/// The limit counts from the command's beginning, loading included.
RenderControl control_from(Clock::time_point begin, const RenderOptions& options) {
    constexpr double least = 1e-6;  // seconds: 0 would be no limit
    RenderControl control = options.control;
    if (control.time_limit > 0)
        control.time_limit =
            std::max(least, control.time_limit - std::chrono::duration<double>(Clock::now() - begin).count());
    return control;
}

Rendered render_watched(const Scene& scene, const RenderOptions& options, Clock::time_point begin,
                        EventStream& events) {
    ProgressBar bar;
    const bool watched = error_is_terminal() && !options.quiet && !options.no_progress;
    Reporter reporter(watched ? &bar : nullptr, options.quiet, events);
    catch_first_interrupt();
    Image image = render(scene, options.settings, control_from(begin, options), &reporter);
    return {std::move(image), reporter.stats(), {}};
}

void warn_of_lost_samples(const RenderStats& stats, const std::string& command, const RenderOptions& options,
                          EventStream& events) {
    if (stats.non_finite_rays > 0)
        warn(fmt::format("{} rays of records and gaps were not finite and count as black",
                         stats.non_finite_rays),
             options, events);
    if (stats.non_finite_samples == 0) return;
    std::string text = fmt::format("{} of {} samples were not finite and are left out",
                                   stats.non_finite_samples, stats.samples + stats.non_finite_samples);
    if (const auto& first = stats.first_non_finite)
        text += fmt::format("; the first again: {} --only-sample {},{},{}", command, (*first)[0], (*first)[1],
                            (*first)[2]);
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
    const double seconds =
        stats.total_seconds + (stats.checkpoint ? stats.checkpoint->earlier_seconds : 0);  // as counts
    std::string line = fmt::format("{}{}: {} x {} pixels, {} samples, {:.2f} s, {:.2f} Mrays/s, {}",
                                   stats.stopped ? "stopped; wrote " : "", options.outputs.front(),
                                   rendered.image.width, rendered.image.height, stats.samples, seconds,
                                   static_cast<double>(stats.total_rays) / std::max(seconds, 1e-9) / 1e6,
                                   bytes_text(static_cast<double>(stats.peak_memory_bytes)));
    if (rendered.error) line += fmt::format(", relative L1 {:.4g}", rendered.error->relative_l1);
    print_line(line);
}

void refuse_emptiness(const RenderStats& stats, const RenderOptions& options) {
    if (!stats.stopped || stats.samples > 0) return;
    const bool signal = stats.stopped_by == "observer";
    throw Error(
        fmt::format("{}: expected at least one sample per pixel, found a {} before it; nothing is written{}",
                    options.outputs.front(), signal ? "signal" : stats.stopped_by,
                    signal || options.settings.method == "path" ? "" : " (--method path is sooner there)"));
}

/// Once the pictures are safe, nobody needs it.
void remove_checkpoint(const RenderOptions& options) {
    if (!options.control.checkpoint.empty()) std::remove(options.control.checkpoint.c_str());
}

ExitCode render_to_files(const RenderOptions& options, const std::string& command, Clock::time_point begin,
                         EventStream& events) {
    check_before_work(options);
    const Scene scene = load_scene(options.scene, options.scene_options);
    const SceneInfo info = scene.info();
    for (const std::string& warning : info.warnings) warn(warning, options, events);
    std::optional<Image> reference;
    if (!options.reference.empty())
        reference = read_reference(options.reference, picture_frame(scene, options.settings));

    Rendered rendered = render_watched(scene, options, begin, events);
    refuse_emptiness(rendered.stats, options);
    warn_of_lost_samples(rendered.stats, command, options, events);

    rendered.image.metadata["relumine.command"] = command;
    save(rendered.image, options);
    if (!rendered.stats.stopped) remove_checkpoint(options);
    const ExitCode code = rendered.stats.stopped_by == "observer" ? ExitCode::stopped : ExitCode::done;
    nlohmann::ordered_json stats = stats_json(command, options, info, rendered.image, rendered.stats);
    if (reference) {
        rendered.error = compare_images(rendered.image, *reference);
        stats["reference"] = reference_json(options.reference, *rendered.error);
        if (const auto coverage = error_coverage(rendered.image, *reference))
            stats["reference"]["coverage"] = coverage_json(*coverage);
    }
    if (!options.stats_file.empty()) write_text(options.stats_file, json_text(stats, 2) + "\n");
    events.finished(static_cast<int>(code), stats);
    print_summary(rendered, options);
    return code;
}

/// `--only-sample`: no picture, but what one sample brings.
ExitCode replay(const RenderOptions& options, EventStream& events) {
    validate(options.settings);
    const Scene scene = load_scene(options.scene, options.scene_options);
    const auto& [x, y, sample] = *options.only_sample;
    const ReplayedSample replayed = replay_sample(scene, options.settings, x, y, sample);
    if (options.json_events)
        events.sample(sample_json(*options.only_sample, replayed));
    else
        print(sample_text(*options.only_sample, replayed));
    return ExitCode::done;
}

}  // namespace

ExitCode run_render(const Arguments& arguments) {
    const Clock::time_point begin = Clock::now();
    const std::optional<RenderOptions> options = parse_render_options(arguments);
    if (!options) return ExitCode::done;
    EventStream events(options->json_events);
    try {
        if (!options->instruction_set.empty()) choose_instruction_set(options->instruction_set);
        if (options->only_sample) return replay(*options, events);
        return render_to_files(*options, command_line(arguments), begin, events);
    } catch (const std::exception& error) {
        events.error(line_of(error), static_cast<int>(exit_code_of(error)));
        throw;
    }
}

}  // namespace relumine::cli
