// SPDX-License-Identifier: Apache-2.0
// The options of `relumine render`: the table of docs/command.md, and what of it does not exist yet.
#include "cli/render_options.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>

namespace relumine::cli {
namespace {

constexpr std::array<NotYet, 3> options_not_yet{{
    {"--preview", "the live preview"},
    {"--denoise", "the denoiser"},
    {"--tev", "the live view in tev"},
}};
constexpr std::array<NotYet, 1> values_not_yet{{
    {"--radiance photons", "precomputed radiance"},
}};

constexpr std::string_view exit_code_help =
    "Exit codes: 0 done; 1 bad input or failed output; 2 bad usage; 3 stopped by a signal, picture saved.";

/// Throws for a value that is documented but does not exist yet.
void refuse_planned_value(const std::string& option, const std::string& value) {
    const auto planned = std::ranges::find(values_not_yet, option + " " + value, &NotYet::name);
    if (planned != values_not_yet.end()) throw refusal(*planned);
}

bool parse_switch(const std::string& option, const std::string& value) {
    if (value == "on" || value == "off") return value == "on";
    throw unexpected_value(option, "on or off", value);
}

/// "640x480" → 640, 480.
void parse_size(const std::string& text, RenderSettings& settings) {
    const std::size_t x = text.find_first_of("xX");
    const auto bad = [&] {
        return unexpected_value("--size", "WIDTHxHEIGHT in pixels, such as 640x480", text);
    };
    if (x == std::string::npos) throw bad();
    try {
        settings.width = parse_number<int>("--size", std::string_view(text).substr(0, x));
        settings.height = parse_number<int>("--size", std::string_view(text).substr(x + 1));
    } catch (const UsageError&) {
        throw bad();
    }
    if (settings.width < 1 || settings.height < 1) throw bad();
}

PixelRect parse_crop(const std::vector<std::string>& text) {
    std::array<int, 4> edge{};
    std::ranges::transform(text, edge.begin(), [](const auto& t) { return parse_number<int>("--crop", t); });
    return {edge[0], edge[1], edge[2], edge[3]};
}

/// "4G" → 4 · 1024³.
std::uint64_t parse_bytes(const std::string& option, const std::string& text) {
    constexpr std::string_view units = "KMGT";
    const std::size_t unit = text.empty() ? units.npos : units.find(text.back());
    const int shift = unit == units.npos ? 0 : 10 * (static_cast<int>(unit) + 1);
    const auto count = parse_number<std::uint64_t>(
        option, std::string_view(text).substr(0, text.size() - (shift > 0 ? 1 : 0)));
    if (count == 0 || count > std::numeric_limits<std::uint64_t>::max() >> shift)
        throw unexpected_value(option, "a number of bytes above 0, such as 500M or 4G", text);
    return count << shift;
}

std::vector<std::string> split_at_commas(const std::string& text) {
    std::vector<std::string> parts;
    for (std::size_t begin = 0; begin <= text.size();) {
        const std::size_t end = std::min(text.find(',', begin), text.size());
        parts.push_back(text.substr(begin, end - begin));
        begin = end + 1;
    }
    return parts;
}

OnlySample parse_only_sample(const std::string& text) {
    const std::vector<std::string> parts = split_at_commas(text);
    if (parts.size() != 3)
        throw unexpected_value("--only-sample", "X,Y,I: a pixel and the number of its sample", text);
    return {parse_number<int>("--only-sample", parts[0]), parse_number<int>("--only-sample", parts[1]),
            parse_number<std::uint32_t>("--only-sample", parts[2])};
}

void add_output_options(CLI::App& app, RenderOptions& options) {
    add_file(app, {"SCENE", "", ".gltf, .glb; .ply, .ply.gz, .obj open as a model under a built-in sky"},
             options.scene);
    add_access_options(app, options.scene_options);
    app.add_option("-o,--output", options.outputs, "the picture: .exr, .png or .pfm; may be repeated")
        ->type_name("FILE")
        ->option_text("FILE REQUIRED")
        ->allow_extra_args(false)
        ->required();
    add_value(app, {"--aov", "LIST", "further layers for .exr, separated by commas"}, "",
              [&](const std::string& list) { options.settings.aovs = split_at_commas(list); });
    add_number(app, {"--exposure", "EV", "stops, for .png"}, options.write.exposure, "0");
    app.add_flag("--half", options.write.half_floats, "16-bit floats in .exr, where the layer allows it");
}

void add_sampling_options(CLI::App& app, RenderSettings& s) {
    add_value(app, {"--method", "M", fmt::format("{}", fmt::join(render_methods(), ", "))}, s.method,
              [&](const std::string& method) {
                  refuse_planned_value("--method", method);
                  s.method = method;
              });
    add_number(app, {"--spp", "N", "camera samples per pixel"}, s.samples_per_pixel,
               std::to_string(s.samples_per_pixel));
    add_text(app, {"--pixel-sampling", "P", "where in the pixel: jitter, center"}, s.pixel_sampling);
    add_text(app, {"--pixel-filter", "F", "box, blackman-harris"}, s.pixel_filter);
    add_text(app, {"--sampler", "S", "auto, sobol, stratified, independent"}, s.sampler);
    add_number(app, {"--gather-rays", "N", "rays per shading point, for gather and reproject-mc"},
               s.gather_rays, std::to_string(s.gather_rays));
    add_number(
        app,
        {"--light-samples", "N", "shadow rays to the bright light per shading point, for gather and cache"},
        s.light_samples, "gather: 0, cache: by --error, others: 16 per pixel");
    add_value(app, {"--gather-packets", "on|off", "trace the rays of gather sixteen at a time"}, "on",
              [&](const std::string& value) { s.gather_packets = parse_switch("--gather-packets", value); });
    add_number(app, {"--seed", "N", "same seed, same bits"}, s.seed, "0");
}

/// Of the methods that keep records, beside those that other commands share.
void add_method_options(CLI::App& app, RenderSettings& s) {
    add_number(
        app,
        {"--bsdf-share", "X", "share of reproject-mc's rays drawn from the BSDF; 0: the paper's, biased"},
        s.bsdf_share, "0.1");
    add_text(app, {"--cache-scope", "S", "image, or tile: tiles of 64 x 64 pixels with records of their own"},
             s.cache_scope);
}

void add_cache_options(CLI::App& app, RenderSettings& s) {
    add_number(app, {"--error", "E", "the relative error to aim at"}, s.error, "0.02");
    app.add_flag("--unbiased", s.unbiased, "the expectation is exact, nothing is filtered");
    add_value(
        app, {"--filter-residual", "on|off", "smooth what residual rays find"}, "on",
        [&](const std::string& value) { s.filter_residual = parse_switch("--filter-residual", value); });
    add_number(app, {"--residual-rays", "N", "rays per camera sample for what the maps get wrong"},
               s.residual_rays, "by --error");
    add_value(app,
              {"--without", "LIST",
               fmt::format("leave out parts, to see what they are worth: {}", fmt::join(cache_parts(), ","))},
              "nothing", [&](const std::string& list) { s.without = split_at_commas(list); });
}

/// Of irradiance-cache and radiance-cache.
void add_rival_options(CLI::App& app, RenderSettings& s) {
    add_number(app, {"--accuracy", "A", "up to which error a record is used [Ward88]"}, s.accuracy, "0.2");
    add_number(app, {"--glossy-rays", "N", "rays per camera sample along lobes that records do not hold"},
               s.glossy_rays, "64 per pixel");
    add_number(app, {"--harmonics", "N", "bands of the harmonics in radiance-cache's records"}, s.harmonics,
               std::to_string(s.harmonics));
}

void add_crop_option(CLI::App& app, RenderSettings& s) {
    app.add_option_function<std::vector<std::string>>(
           "--crop", [&](const std::vector<std::string>& edges) { s.crop = parse_crop(edges); },
           "only the pixels X0 <= x < X1, Y0 <= y < Y1 of the full frame")
        ->expected(4)
        ->type_name("edges")
        ->option_text("X0 Y0 X1 Y1");
}

void add_keeping_options(CLI::App& app, RenderOptions& options) {
    RenderControl& control = options.control;
    add_number(app, {"--time-limit", "S", "seconds after which the picture so far is written"},
               control.time_limit, "none");
    add_value(app, {"--memory-limit", "BYTES", "of the process; K, M, G, T: powers of 1024"}, "none",
              [&](const std::string& text) { control.memory_limit = parse_bytes("--memory-limit", text); });
    add_value(app, {"--texture-limit", "BYTES", "of all textures, which are halved until they fit"},
              "half of --memory-limit", [&](const std::string& text) {
                  options.scene_options.texture_limit = parse_bytes("--texture-limit", text);
              });
    add_text(app, {"--checkpoint", "FILE", "keeps what is done; removed when the pictures are written"},
             control.checkpoint);
    add_number(app, {"--checkpoint-interval", "S", "seconds between checkpoints"},
               control.checkpoint_interval, "60");
    app.add_flag("--resume", control.resume, "goes on from the checkpoint, to the same bits");
    add_value(app, {"--only-sample", "X,Y,I", "instead of the picture: what sample I of pixel X,Y brings"},
              "", [&](const std::string& text) { options.only_sample = parse_only_sample(text); });
}

void add_running_options(CLI::App& app, RenderOptions& options) {
    add_number(app, {"--threads", "N", "0: all; never changes the picture"}, options.settings.threads, "0");
    add_text(
        app,
        {"--isa", "NAME",
         fmt::format("vector instructions: {}; the last by default", fmt::join(instruction_sets(), ", "))},
        options.instruction_set);
    add_text(app, {"--reference", "FILE", "also tells how far the picture is from this one"},
             options.reference);
    add_text(app, {"--stats", "FILE", "statistics as JSON, \"-\" for stdout; keys: docs/statistics.md"},
             options.stats_file);
    app.add_flag("--json-events", options.json_events, "progress on stdout, one JSON object per line");
    app.add_flag("-q,--quiet", options.quiet, "no progress and no warnings on stderr");
    app.add_flag("--no-progress", options.no_progress,
                 "no progress on stderr (it is shown on terminals alone)");
}

void add_options(CLI::App& app, RenderOptions& options) {
    app.option_defaults()->group("Output");
    add_output_options(app, options);
    app.option_defaults()->group("Method and sampling");
    add_sampling_options(app, options.settings);
    app.option_defaults()->group("Quality (cache)");
    add_cache_options(app, options.settings);
    app.option_defaults()->group("Records (reproject, reproject-mc)");
    add_record_options(app, options.settings);
    add_method_options(app, options.settings);
    app.option_defaults()->group("Records (irradiance-cache, radiance-cache)");
    add_rival_options(app, options.settings);
    app.option_defaults()->group("Light");
    add_light_options(app, options.settings);
    add_environment_options(app, options.scene_options);
    app.option_defaults()->group("Camera");
    add_frame_options(app, options.settings);
    add_crop_option(app, options.settings);
    app.option_defaults()->group("Running");
    add_running_options(app, options);
    app.option_defaults()->group("Limits and interruptions");
    add_keeping_options(app, options);
}

void refuse_contradictions(const RenderOptions& options) {
    if (options.json_events && options.stats_file == "-")
        throw UsageError(
            "--stats: expected a file beside --json-events, whose last line holds the statistics, found "
            "\"-\"");
    if (options.control.resume && options.control.checkpoint.empty())
        throw UsageError("--resume: expected --checkpoint FILE beside it, found none");
}

}  // namespace

void add_record_options(CLI::App& app, RenderSettings& s) {
    add_number(app, {"--record-size", "n", "rays along each side of a record's square: 16, 32, 64, 128"},
               s.record_size, std::to_string(s.record_size));
    add_number(app, {"--record-layers", "K", "depth layers of a record"}, s.record_layers,
               std::to_string(s.record_layers));
    add_number(app, {"--record-spacing", "X", "factor on how far records are used"}, s.record_spacing, "1");
    add_number(app, {"--records-per-point", "M", "the most records that one point uses"}, s.records_per_point,
               std::to_string(s.records_per_point));
    add_number(app, {"--gap-cell", "k", "one ray for the gaps of k x k bits of 128 x 128: 1, 2, 4, 8"},
               s.gap_cell, std::to_string(s.gap_cell));
}

void add_light_options(CLI::App& app, RenderSettings& s) {
    add_number(
        app, {"--max-depth", "N", "scattering vertices of a path: 0 emission, 1 direct light; -1 unlimited"},
        s.max_depth, "-1");
    add_value(app,
              {"--radiance", "S", "what a gather ray brings back: auto, emission, direct, radiosity, path"},
              s.radiance, [&](const std::string& source) {
                  refuse_planned_value("--radiance", source);
                  s.radiance = source;
              });
    add_text(app, {"--guide", "G", "what attracts the paths of path and cache --unbiased: none, field"},
             s.guide);
    add_number(app, {"--photons", "N", "paths from lights for caustics, beside a radiance field"}, s.photons,
               "none");
    add_text(app, {"--masking", "M", "of microfacets: correlated, separable"}, s.masking);
}

void add_environment_options(CLI::App& app, SceneOptions& scene) {
    add_text(app, {"--environment", "FILE", "lat-long .exr, .hdr or .pfm that replaces the scene's own"},
             scene.environment);
    add_number(app, {"--env-scale", "X", "multiplies the environment's radiance"}, scene.environment_scale,
               "1");
    add_number(app, {"--env-rotate", "DEG", "counter-clockwise seen from +Y"},
               scene.environment_rotation_degrees, "0");
    app.add_option_function<std::vector<std::string>>(
           "-D,--define",
           [&scene](const std::vector<std::string>& definitions) {
               for (const std::string& text : definitions) {
                   const std::size_t equals = text.find('=');
                   if (equals == 0 || equals == text.npos)
                       throw CLI::ValidationError{"--define", "expected NAME=VALUE, found " + text};
                   scene.definitions[text.substr(0, equals)] = text.substr(equals + 1);
               }
           },
           "the value of a Mitsuba scene's $NAME; may be given several times")
        ->type_name("NAME=VALUE")
        ->allow_extra_args(false);
}

void add_access_options(CLI::App& app, SceneOptions& scene) {
    app.add_option("--allow-dir", scene.allowed_folders,
                   "files that SCENE names may lie here too, besides its own folder; may be repeated")
        ->type_name("DIR")
        ->option_text("DIR")
        ->allow_extra_args(false);
}

void add_frame_options(CLI::App& app, RenderSettings& s) {
    add_text(app, {"--camera", "NAME|INDEX", "the first by default; a framing one where there is none"},
             s.camera);
    add_value(app, {"--size", "WxH", "pixels of the full frame"}, "1024 wide by the camera's aspect",
              [&](const std::string& size) { parse_size(size, s); });
}

std::optional<RenderOptions> parse_render_options(const Arguments& arguments) {
    CLI::App app("Renders SCENE and writes the picture.", "relumine render");
    RenderOptions options;
    add_options(app, options);
    app.footer(fmt::format("Layers for --aov: {}.\n{}", fmt::join(aov_names(), ", "), exit_code_help));
    if (!parse(app, arguments, options_not_yet)) return std::nullopt;
    refuse_contradictions(options);
    if (options.scene_options.texture_limit == 0)
        options.scene_options.texture_limit = options.control.memory_limit / 2;
    return options;
}

}  // namespace relumine::cli
