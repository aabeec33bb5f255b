// SPDX-License-Identifier: Apache-2.0
// Which settings exist and which of their values make sense.
#include <fmt/format.h>

#include <algorithm>

#include "base/message.hpp"
#include "film/film.hpp"
#include "integrators/registry.hpp"
#include "relumine/error.hpp"
#include "relumine/render.hpp"

namespace relumine {
namespace {

constexpr int max_side = 65536;  // pixels

void check_name(const char* setting, const std::string& value, const std::vector<std::string>& known) {
    if (std::ranges::find(known, value) != known.end()) return;
    throw SettingsError{
        expected_found(setting, one_of(known), "\"" + value + "\"" + did_you_mean(value, known))};
}

void check_range(const char* setting, std::int64_t value, std::int64_t least, std::int64_t most) {
    if (value >= least && value <= most) return;
    throw SettingsError{expected_found(setting, fmt::format("{} to {}", least, most), std::to_string(value))};
}

void check_frame(const RenderSettings& s) {
    if ((s.width == 0) != (s.height == 0))
        throw SettingsError{
            expected_found("size", "width and height, or neither", fmt::format("{}x{}", s.width, s.height))};
    check_range("width", s.width, 0, max_side);
    check_range("height", s.height, 0, max_side);
}

void check_choice(const char* setting, int value, std::initializer_list<int> choices) {
    if (std::ranges::find(choices, value) != choices.end()) return;
    throw SettingsError{
        expected_found(setting, fmt::format("one of {}", fmt::join(choices, ", ")), std::to_string(value))};
}

void check_real(const char* setting, float value, float least, float most) {
    if (value >= least && value <= most) return;
    throw SettingsError{
        expected_found(setting, fmt::format("{} to {}", least, most), fmt::format("{}", value))};
}

void check_cache(const RenderSettings& s) {
    check_choice("record size", s.record_size, {16, 32, 64, 128});
    check_range("record layers", s.record_layers, 1, 64);
    check_real("record spacing", s.record_spacing, 0.01f, 100);
    check_range("records per point", s.records_per_point, 1, 16);
    check_choice("gap cell", s.gap_cell, {1, 2, 4, 8});
    check_real("BSDF share", s.bsdf_share, 0, 1);
    check_real("accuracy", s.accuracy, 0.02f, 1);
    check_range("harmonics", s.harmonics, 3, 16);
    check_name("cache scope", s.cache_scope, {"image", "tile"});
}

void check_names(const char* setting, const char* kind, const std::vector<std::string>& names,
                 const std::vector<std::string>& known) {
    for (auto name = names.begin(); name != names.end(); ++name) {
        check_name(setting, *name, known);
        if (std::find(names.begin(), name, *name) != name)
            throw SettingsError{
                expected_found(setting, fmt::format("each {} once", kind), "\"" + *name + "\" twice")};
    }
}

}  // namespace

std::vector<std::string> render_methods() { return integrator_names(); }

std::vector<std::string> aov_names() { return film_layer_names(); }

std::vector<std::string> cache_parts() { return {"reprojection", "splits", "blending", "sharp-lobes"}; }

void validate(const RenderSettings& s) {
    constexpr std::int64_t million = std::int64_t{1} << 20, max_rays_per_pixel = std::int64_t{1} << 31;
    check_name("method", s.method, render_methods());
    check_range("samples per pixel", s.samples_per_pixel, 1, million);
    check_name("pixel sampling", s.pixel_sampling, {"jitter", "center"});
    check_name("pixel filter", s.pixel_filter, {"box", "blackman-harris"});
    check_name("sampler", s.sampler, {"auto", "sobol", "stratified", "independent"});
    check_range("gather rays", s.gather_rays, 1, million);
    check_range("glossy rays", s.glossy_rays, -1, million);
    check_range("light samples", s.light_samples, -1, million);
    check_range("residual rays", s.residual_rays, -1, million);
    check_real("error", s.error, 0.0005f, 0.5f);
    // Rays' numbers are 32-bit indices into one sequence per pixel.
    if (s.method == "gather" || s.method.starts_with("reproject"))
        check_range("gather rays × samples per pixel", std::int64_t{s.gather_rays} * s.samples_per_pixel, 1,
                    max_rays_per_pixel);
    if (s.method != "path") {
        check_range("glossy rays × samples per pixel", std::int64_t{s.glossy_rays} * s.samples_per_pixel,
                    -million, max_rays_per_pixel);
        check_range("light samples × samples per pixel", std::int64_t{s.light_samples} * s.samples_per_pixel,
                    -million, max_rays_per_pixel);
    }
    check_cache(s);
    check_names("without", "part", s.without, cache_parts());
    check_range("max depth", s.max_depth, -1, million);
    check_name("radiance", s.radiance, {"auto", "emission", "direct", "radiosity", "path"});
    check_name("guide", s.guide, {"none", "field"});
    check_range("photons", s.photons, -1, std::int64_t{1} << 24);
    check_name("masking", s.masking, {"correlated", "separable"});
    check_range("threads", s.threads, 0, 4096);
    check_frame(s);
    check_names("aov", "layer", s.aovs, aov_names());
}

}  // namespace relumine
