// SPDX-License-Identifier: Apache-2.0
// Scenes, settings and statistics in words and as JSON.
#include "cli/report.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "cli/console.hpp"

namespace relumine::cli {
namespace {

using Json = nlohmann::ordered_json;

Json rect_json(const PixelRect& rect) { return {rect.x0, rect.y0, rect.x1, rect.y1}; }

Json picture_json(const Image& image) {
    return {{"width", image.width},
            {"height", image.height},
            {"window", rect_json(image.window)},
            {"frame_width", image.frame_width},
            {"frame_height", image.frame_height}};
}

Json settings_json(const RenderSettings& s, const SceneOptions& scene) {
    return {{"method", s.method},
            {"samples_per_pixel", s.samples_per_pixel},
            {"pixel_sampling", s.pixel_sampling},
            {"pixel_filter", s.pixel_filter},
            {"sampler", s.sampler},
            {"gather_rays", s.gather_rays},
            {"gather_packets", s.gather_packets},
            {"record_size", s.record_size},
            {"record_layers", s.record_layers},
            {"record_spacing", s.record_spacing},
            {"records_per_point", s.records_per_point},
            {"gap_cell", s.gap_cell},
            {"bsdf_share", s.bsdf_share},
            {"cache_scope", s.cache_scope},
            {"error", s.error},
            {"unbiased", s.unbiased},
            {"filter_residual", s.filter_residual},
            {"residual_rays", s.residual_rays},
            {"without", s.without},
            {"accuracy", s.accuracy},
            {"glossy_rays", s.glossy_rays},
            {"harmonics", s.harmonics},
            {"light_samples", s.light_samples},
            {"max_depth", s.max_depth},
            {"radiance", s.radiance},
            {"guide", s.guide},
            {"photons", s.photons},
            {"masking", s.masking},
            {"camera", s.camera},
            {"width", s.width},
            {"height", s.height},
            {"crop", s.crop ? rect_json(*s.crop) : Json()},
            {"threads", s.threads},
            {"seed", s.seed},
            {"aovs", s.aovs},
            {"environment", scene.environment},
            {"environment_scale", scene.environment_scale},
            {"environment_rotation_degrees", scene.environment_rotation_degrees}};
}

std::string lights_text(const SceneInfo& info) {
    return fmt::format("{} emissive triangles, {} point, {} spot, {} directional, {}",
                       info.emissive_triangles, info.point_lights, info.spot_lights, info.directional_lights,
                       info.has_environment ? "an environment" : "no environment");
}

std::string cameras_text(const std::vector<std::string>& cameras) {
    if (cameras.empty()) return "none: render frames the scene";
    std::vector<std::string> numbered;
    for (std::size_t i = 0; i < cameras.size(); ++i)
        numbered.push_back(fmt::format("{} \"{}\"", i, one_line(cameras[i])));
    return fmt::format("{}", fmt::join(numbered, ", "));
}

}  // namespace

std::string json_text(const Json& json, int indent) {
    return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

Json scene_json(const std::string& file, const SceneInfo& info) {
    return {{"file", file},
            {"meshes", info.meshes},
            {"instances", info.instances},
            {"triangles", info.triangles},
            {"instanced_triangles", info.instanced_triangles},
            {"materials", info.materials},
            {"textures", info.textures},
            {"emissive_triangles", info.emissive_triangles},
            {"point_lights", info.point_lights},
            {"spot_lights", info.spot_lights},
            {"directional_lights", info.directional_lights},
            {"has_environment", info.has_environment},
            {"cameras", info.cameras},
            {"bounds_min", info.bounds_min},
            {"bounds_max", info.bounds_max},
            {"memory_bytes", info.memory_bytes},
            {"warnings", info.warnings}};
}

std::string scene_text(const std::string& file, const SceneInfo& info) {
    const auto& lo = info.bounds_min;
    const auto& hi = info.bounds_max;
    std::string text = one_line(file) + "\n";
    text += fmt::format("  geometry   {} triangles in {} meshes; {} triangles in {} instances\n",
                        info.triangles, info.meshes, info.instanced_triangles, info.instances);
    text += fmt::format("  bounds     {:g} {:g} {:g} to {:g} {:g} {:g} m\n", lo[0], lo[1], lo[2], hi[0],
                        hi[1], hi[2]);
    text += fmt::format("  materials  {}, with {} textures\n", info.materials, info.textures);
    text += fmt::format("  lights     {}\n", lights_text(info));
    text += fmt::format("  cameras    {}\n", cameras_text(info.cameras));
    text += fmt::format("  memory     {}\n", bytes_text(static_cast<double>(info.memory_bytes)));
    for (const std::string& warning : info.warnings)
        text += fmt::format("  warning    {}\n", one_line(warning));
    return text;
}

Json stats_json(const std::string& command_line, const RenderOptions& options, const SceneInfo& info,
                const Image& image, const RenderStats& stats) {
    Json json{{"version", version()}, {"command", command_line}, {"outputs", options.outputs}};
    json.update(Json::parse(stats.to_json()));
    json["picture"] = picture_json(image);
    json["settings"] = settings_json(options.settings, options.scene_options);
    json["scene"] = scene_json(options.scene, info);
    return json;
}

namespace {

std::array<float, 3> total(const ReplayedSample& s) {
    std::array<float, 3> sum{};
    for (std::size_t c = 0; c < 3; ++c) sum[c] = s.emission[c] + s.direct[c] + s.indirect[c];
    return sum;
}

/// JSON has no numbers for NaN and infinity: text, then.
Json rgb_json(const std::array<float, 3>& rgb) {
    Json json;
    for (const float value : rgb)
        json.push_back(std::isfinite(value) ? Json(value) : Json(fmt::format("{}", value)));
    return json;
}

}  // namespace

Json sample_json(const OnlySample& which, const ReplayedSample& s) {
    return {{"pixel", {which.x, which.y}},
            {"sample", which.sample},
            {"finite", s.finite},
            {"emission", rgb_json(s.emission)},
            {"direct", rgb_json(s.direct)},
            {"indirect", rgb_json(s.indirect)},
            {"radiance", rgb_json(total(s))}};
}

std::string sample_text(const OnlySample& which, const ReplayedSample& s) {
    std::string text = fmt::format("pixel {},{} sample {}: {}\n", which.x, which.y, which.sample,
                                   s.finite ? "finite" : "not finite; a render leaves it out");
    for (const auto& [name, rgb] : {std::pair{"emission", s.emission}, std::pair{"direct", s.direct},
                                    std::pair{"indirect", s.indirect}, std::pair{"radiance", total(s)}})
        text += fmt::format("  {:<10} {} {} {}\n", name, rgb[0], rgb[1], rgb[2]);
    return text;
}

std::string bytes_text(double bytes) {
    const char* unit = "B";
    for (const char* larger : {"kB", "MB", "GB", "TB"}) {
        if (bytes < 1000) break;
        bytes /= 1000;
        unit = larger;
    }
    return fmt::format("{:.3g} {}", bytes, unit);
}

}  // namespace relumine::cli
