// SPDX-License-Identifier: Apache-2.0
// The body of the public render(): ties scene, tracer, integrator and film together.
#include "relumine/render.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "base/executor.hpp"
#include "base/memory.hpp"
#include "film/film.hpp"
#include "integrators/registry.hpp"
#include "memory_needs.hpp"
#include "relumine/compare.hpp"
#include "relumine/error.hpp"
#include "render_keeper.hpp"
#include "render_monitor.hpp"
#include "render_passes.hpp"
#include "render_setup.hpp"
#include "scene/finish_scene.hpp"

namespace relumine {
namespace {

FieldStats field_stats(const FieldFigures& f) {
    return {f.elements, f.links, f.iterations, f.bytes, f.unresolved};
}

/// What stands in the picture's header.
void describe(Image& image, const RenderSettings& settings, const RenderStats& stats) {
    image.metadata["relumine.version"] = version();
    image.metadata["relumine.method"] = settings.method;
    image.metadata["relumine.seed"] = std::to_string(settings.seed);
    image.metadata["relumine.samples_per_pixel"] = std::to_string(settings.samples_per_pixel);
    image.metadata["relumine.samples"] = std::to_string(stats.samples);
    image.metadata["relumine.seconds"] = fmt::format("{:.3f}", stats.total_seconds);
    if (stats.stopped) image.metadata["relumine.stopped_by"] = stats.stopped_by;
}

void refuse_memory(const RenderControl& control, const RenderSettings& settings, const RenderStats& stats) {
    const std::string kept =
        control.checkpoint.empty() ? "" : fmt::format("; {} keeps what is done", control.checkpoint);
    const char* way_out = settings.method == "path" ? "" : "; --method path takes the least";
    throw Error{fmt::format("memory limit: expected at most {} bytes in use, found {} after {} samples{}{}",
                            control.memory_limit, resident_bytes(), stats.samples, kept, way_out)};
}

/// Where nothing emits, the picture is black without following any light.
RenderSettings as_far_as_lit(RenderSettings settings, const SceneData& scene) {
    if (!emits_light(scene)) settings.max_depth = 0;
    return settings;
}

/// Whether what a memory limit leaves shows in the picture.
bool thins(const RenderSettings& settings) {
    constexpr std::array<std::string_view, 4> methods{"reproject", "reproject-mc", "cache", "block-gather"};
    return wants_field(settings) || std::ranges::find(methods, settings.method) != methods.end();
}

/// Where a checkpoint is asked for: everything that the bits of the picture depend on.
Identity identity_for(const RenderControl& control, const SceneData& scene, const RenderSettings& settings) {
    if (control.checkpoint.empty()) return {};
    Identity identity = picture_identity(scene, settings);
    const std::uint64_t limit = thins(settings) ? control.memory_limit : 0;
    identity.emplace_back("memory limit", limit > 0 ? fmt::format("{} bytes", limit) : "none");
    return identity;
}

/// Of the memory that is left, what the field may take, and what the method's records or maps may: the rest
/// is for what is not counted. The same with a checkpoint and without, since it shows in the picture.
constexpr double share_of_field = 0.5, share_of_method = 0.8;

std::uint64_t share_of_room(double share, const MemoryNeeds& needs_with_checkpoint,
                            const RenderControl& control) {
    const std::uint64_t room = room_beside(needs_with_checkpoint, control);
    return room == no_limit ? no_limit : static_cast<std::uint64_t>(share * static_cast<double>(room));
}

}  // namespace

Image render(const Scene& scene, const RenderSettings& settings, RenderObserver* observer) {
    return render(scene, settings, RenderControl{}, observer);
}

Image render(const Scene& scene, const RenderSettings& wanted, const RenderControl& control,
             RenderObserver* observer) {
    validate(wanted);
    validate(control);
    const SceneData& data = scene.data();
    const RenderSettings settings = as_far_as_lit(wanted, data);
    const Framing framing = find_framing(data, settings);
    const int threads = resolve_threads(settings.threads);

    Monitor monitor(observer, control);
    Keeper keeper(control, identity_for(control, data, settings),
                  [&](const std::string& text) { monitor.warn(text); });
    const std::optional<Checkpoint> earlier = keeper.find();
    check_memory(control, needed_before_building(scene, settings, framing, keeper.active()));
    if (settings.guide != "none" && !wants_guide(settings))
        monitor.warn(
            fmt::format("guide: expected --method path or cache --unbiased, found {}, which does not use it",
                        settings.method));
    RenderSetup setup(data, settings, framing, [&](const char* stage) { monitor.begin_stage(stage); });
    if (wants_field(settings)) {
        RayCounts rays;
        monitor.begin_stage("field");
        const MemoryNeeds needs = needed_before_building(scene, settings, framing, true);
        setup.add_field(
            settings, [&] { return monitor.stop(); }, share_of_room(share_of_field, needs, control), rays);
        monitor.add(rays);
    }
    const auto integrator =
        make_integrator(settings, setup.transport, setup.view, needs_surfaces(settings.aovs));
    const auto needs = [&](bool checkpoint) {
        return needed_with(*integrator, setup.field.get(), scene, settings, framing, checkpoint);
    };
    check_memory(control, needs(keeper.active()));
    if (control.memory_limit > 0)
        integrator->keep_within(share_of_room(share_of_method, needs(true), control));

    Film film(framing.width, framing.height, framing.window, settings.aovs);
    PassRunner runner(*integrator, framing.window, setup.view.samples_per_pixel, threads, film, monitor,
                      keeper);
    if (earlier) runner.resume(*earlier, control.checkpoint);
    const std::uint64_t earlier_samples = film.samples();
    const bool whole = runner.run();
    Image image = film.develop();
    RenderStats stats = monitor.stats(threads);
    stats.samples = film.samples();
    if (setup.field) stats.field = field_stats(setup.field->figures());
    if (whole) {
        stats.stopped = false;
        stats.stopped_by.clear();
    }
    if (keeper.active())
        stats.checkpoint = {earlier.has_value(), earlier_samples, earlier ? earlier->work.seconds : 0,
                            keeper.written(), keeper.failed()};
    if (!whole && monitor.stop_reason() == StopReason::memory) refuse_memory(control, settings, stats);
    stats.predicted_error = predicted_relative_l1(image);
    describe(image, settings, stats);
    if (observer) observer->finished(stats);
    return image;
}

PictureFrame picture_frame(const Scene& scene, const RenderSettings& settings) {
    const Framing framing = find_framing(scene.data(), settings);
    return {framing.width, framing.height, framing.window};
}

const char* version() { return RELUMINE_VERSION; }

}  // namespace relumine
