// SPDX-License-Identifier: Apache-2.0
// Checkpoints of a render. The list of settings takes them apart by name, so that a new one does not compile
// here until it is listed.
#include "render_keeper.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <filesystem>

#include "base/file.hpp"
#include "base/instruction_set.hpp"
#include "base/message.hpp"
#include "relumine/error.hpp"
#include "scene/scene_fingerprint.hpp"
#include "trace/tracer.hpp"

namespace relumine {
namespace {

namespace fs = std::filesystem;

std::string text_of(const std::string& value) { return value; }
std::string text_of(bool value) { return value ? "on" : "off"; }
std::string text_of(const std::vector<std::string>& values) {
    return fmt::format("{}", fmt::join(values, ","));
}
std::string text_of(const std::optional<PixelRect>& r) {
    return r ? fmt::format("{} {} {} {}", r->x0, r->y0, r->x1, r->y1) : "none";
}
template <typename Number>
requires std::is_arithmetic_v<Number> std::string text_of(Number value) { return fmt::format("{}", value); }

Identity settings_identity(const RenderSettings& settings) {
    const auto& [method, samples_per_pixel, pixel_sampling, pixel_filter, sampler, gather_rays,
                 gather_packets, light_samples, max_depth, radiance, guide, photons, record_size,
                 record_layers, record_spacing, records_per_point, gap_cell, bsdf_share, error, unbiased,
                 filter_residual, residual_rays, without, accuracy, glossy_rays, harmonics, cache_scope,
                 masking, camera, width, height, crop, threads, seed, aovs] = settings;
    (void)threads;  // never changes a bit
    return {{"method", text_of(method)},
            {"samples per pixel", text_of(samples_per_pixel)},
            {"pixel sampling", text_of(pixel_sampling)},
            {"pixel filter", text_of(pixel_filter)},
            {"sampler", text_of(sampler)},
            {"gather rays", text_of(gather_rays)},
            {"gather packets", text_of(gather_packets)},
            {"light samples", text_of(light_samples)},
            {"max depth", text_of(max_depth)},
            {"radiance", text_of(radiance)},
            {"guide", text_of(guide)},
            {"photons", text_of(photons)},
            {"record size", text_of(record_size)},
            {"record layers", text_of(record_layers)},
            {"record spacing", text_of(record_spacing)},
            {"records per point", text_of(records_per_point)},
            {"gap cell", text_of(gap_cell)},
            {"BSDF share", text_of(bsdf_share)},
            {"error", text_of(error)},
            {"unbiased", text_of(unbiased)},
            {"filter residual", text_of(filter_residual)},
            {"residual rays", text_of(residual_rays)},
            {"without", text_of(without)},
            {"accuracy", text_of(accuracy)},
            {"glossy rays", text_of(glossy_rays)},
            {"harmonics", text_of(harmonics)},
            {"cache scope", text_of(cache_scope)},
            {"masking", text_of(masking)},
            {"camera", text_of(camera)},
            {"width", text_of(width)},
            {"height", text_of(height)},
            {"crop", text_of(crop)},
            {"seed", text_of(seed)},
            {"aovs", text_of(aovs)}};
}

/// Until it is whole. Always the same name, so that killed renders leave one such file and not many.
std::string unfinished_name(const std::string& checkpoint) { return checkpoint + ".unfinished"; }

}  // namespace

Identity picture_identity(const SceneData& scene, const RenderSettings& settings) {
    Identity identity{{"version", version()},
                      {"instruction set", current_instruction_set()},
                      {"ray tracer", Tracer::library()}};
    for (auto& setting : settings_identity(settings)) identity.push_back(std::move(setting));
    for (const auto& [part, hash] : scene_fingerprint(scene))
        identity.emplace_back("the scene's " + part, fmt::format("{:016x}", hash));
    return identity;
}

void validate(const RenderControl& control) {
    const auto check = [](const char* what, double value) {
        if (!(value >= 0) || !std::isfinite(value))
            throw SettingsError{
                expected_found(what, "a finite number of seconds, at least 0", fmt::format("{}", value))};
    };
    check("time limit", control.time_limit);
    check("checkpoint interval", control.checkpoint_interval);
    if (control.checkpoint.empty()) {
        if (!control.resume) return;
        throw SettingsError{expected_found("resume", "the name of a checkpoint", "none")};
    }
    std::error_code ignored;
    const fs::file_status status = fs::status(control.checkpoint, ignored);
    if (!fs::exists(status)) return;
    if (!fs::is_regular_file(status))
        throw OutputError{expected_found(control.checkpoint, "the name of a file", "something else there")};
    if (!control.resume)
        throw OutputError{expected_found(control.checkpoint, "no file there, or the wish to resume it",
                                         "one that may hold hours of work")};
}

Keeper::Keeper(const RenderControl& control, Identity identity, std::function<void(const std::string&)> warn)
    : control_(control), identity_(std::move(identity)), warn_(std::move(warn)) {}

std::optional<Checkpoint> Keeper::find() const {
    if (!control_.resume) return std::nullopt;
    const std::string& file = control_.checkpoint;
    std::error_code ignored;
    if (!fs::exists(file, ignored)) {
        warn_(expected_found(file, "a checkpoint to go on from", "none; this begins at the beginning"));
        return std::nullopt;
    }
    Checkpoint checkpoint = decode_checkpoint(read_file(file), file);
    check_identity(checkpoint.identity, identity_, file);
    return checkpoint;
}

bool Keeper::due() {
    if (!active()) return false;
    const std::lock_guard lock(mutex_);
    if (busy_ || Clock::now() - last_ < std::chrono::duration<double>(control_.checkpoint_interval))
        return false;
    return busy_ = true;
}

void Keeper::write(Checkpoint checkpoint) {
    if (!active()) return;
    checkpoint.identity = identity_;
    try {
        write_file_atomically(control_.checkpoint, encode_checkpoint(checkpoint),
                              unfinished_name(control_.checkpoint));
        ++written_;
    } catch (const Error& error) {
        if (failed_++ == 0)
            warn_(fmt::format("{}; the render goes on without this checkpoint", error.what()));
    } catch (const std::bad_alloc&) {
        if (failed_++ == 0)
            warn_(fmt::format("{}: expected memory for a checkpoint, found none; the render goes on without",
                              control_.checkpoint));
    }
    const std::lock_guard lock(mutex_);
    busy_ = false;
    last_ = Clock::now();
}

}  // namespace relumine
