// SPDX-License-Identifier: Apache-2.0
// `relumine inspect`: pictures and numbers of what the radiance cache does for one pixel.
#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "cli/command.hpp"
#include "cli/console.hpp"
#include "cli/outputs.hpp"
#include "cli/render_options.hpp"
#include "cli/report.hpp"
#include "relumine/inspect.hpp"

namespace relumine::cli {
namespace {

using Json = nlohmann::ordered_json;

constexpr int picture_side = 512;  // pixels

struct Pixel {
    int x = 0, y = 0;
};

struct Options {
    std::string scene, folder;
    Pixel pixel;
    SceneOptions scene_options;
    RenderSettings settings;
    float exposure = 0;  // stops
    bool json = false;
};

/// "93,114" → 93, 114.
Pixel parse_pixel(const std::string& text) {
    const auto bad = [&] { return unexpected_value("--pixel", "X,Y in pixels, such as 93,114", text); };
    const std::size_t comma = text.find(',');
    if (comma == std::string::npos) throw bad();
    try {
        return {parse_number<int>("--pixel", std::string_view(text).substr(0, comma)),
                parse_number<int>("--pixel", std::string_view(text).substr(comma + 1))};
    } catch (const UsageError&) {
        throw bad();
    }
}

void add_options(CLI::App& app, Options& options) {
    app.option_defaults()->group("What to look at, and where to put it");
    add_file(app, {"SCENE", "", ".gltf, .glb; .ply, .ply.gz, .obj open as a model under a built-in sky"},
             options.scene);
    add_access_options(app, options.scene_options);
    add_value(app, {"--pixel", "X,Y", "of the full frame, from the top left"}, "",
              [&](const std::string& text) { options.pixel = parse_pixel(text); })
        ->option_text("X,Y REQUIRED")
        ->required();
    add_text(app, {"--out", "DIR", "an existing folder for the pictures"}, options.folder)
        ->option_text("DIR REQUIRED")
        ->required();
    add_number(app, {"--exposure", "EV", "stops, for the pictures of radiance"}, options.exposure, "0");
    app.add_flag("--json", options.json, "the report as a JSON object");
    app.option_defaults()->group("The picture that the pixel is of");
    add_frame_options(app, options.settings);
    add_text(app, {"--pixel-sampling", "P", "where in the pixel: jitter, center"},
             options.settings.pixel_sampling);
    add_number(app, {"--seed", "N", "same seed, same bits"}, options.settings.seed, "0");
    app.option_defaults()->group("Records");
    add_record_options(app, options.settings);
    app.option_defaults()->group("Light");
    add_light_options(app, options.settings);
    add_environment_options(app, options.scene_options);
    app.option_defaults()->group("Running");
    add_number(app, {"--threads", "N", "0: all; never changes the pictures"}, options.settings.threads, "0");
}

/// Every pixel as a square of factor × factor.
Image magnified(const Image& image, int factor) {
    Image large{image.width * factor, image.height * factor, {}, 0, 0, {}, image.metadata};
    Layer& layer = large.layers.emplace_back(Layer{"", {"R", "G", "B"}, {}});
    for (int y = 0; y < large.height; ++y)
        for (int x = 0; x < large.width; ++x) {
            const std::array<float, 3> rgb = image.rgb(x / factor, y / factor);
            layer.pixels.insert(layer.pixels.end(), rgb.begin(), rgb.end());
        }
    return large;
}

std::string picture_file(const Options& options, const std::string& name) {
    return (std::filesystem::path(options.folder) / (name + ".png")).string();
}

void save(const Inspection& inspection, const Options& options) {
    for (const auto& [name, image] : inspection.pictures) {
        const bool exposed = image.metadata.at("unit") == "radiance";
        write_image(magnified(image, std::max(1, picture_side / image.width)), picture_file(options, name),
                    {.exposure = exposed ? options.exposure : 0});
    }
}

std::string vector_text(const Json& v) {
    return fmt::format("{:.6g} {:.6g} {:.6g}", v[0].get<double>(), v[1].get<double>(), v[2].get<double>());
}

std::string metres_text(const Json& distance) {
    return distance.is_null() ? "infinite" : fmt::format("{:.4g} m", distance.get<double>());
}

std::string record_text(const Json& r) {
    std::string text = fmt::format(
        "record {:<6} pixel {},{}; {} away, {:.4g} m of it along the normal;\n"
        "              normals {:.3g} degrees apart, unsuitability {:.3g}\n"
        "              reaches {} and {} pixels; nearest hit {}, harmonic mean {}\n"
        "              {} surfels in {} layers, {}\n",
        r["id"].get<std::uint32_t>(), r["pixel"][0].get<int>(), r["pixel"][1].get<int>(),
        metres_text(r["distance"]), r["height"].get<double>(), r["normal_angle_degrees"].get<double>(),
        r["unsuitability"].get<double>(), metres_text(r["reach"]), r["pixel_reach"].get<int>(),
        metres_text(r["nearest_distance"]), metres_text(r["harmonic_distance"]),
        r["surfels"].get<std::size_t>(), r["layers"].get<std::size_t>(),
        bytes_text(r["bytes"].get<double>()));
    if (!r["used"].get<bool>()) return text + "              not needed\n";
    const Json& after = r["after"];
    return text
           + fmt::format("              after it {:.2f} % covered, {:.2f} % unknown, {:.2f} % gaps\n",
                         100 * after["covered"].get<double>(), 100 * after["unknown"].get<double>(),
                         100 * after["gaps"].get<double>());
}

std::string report_text(const Json& report, const Options& options) {
    std::string text = fmt::format("pixel         {},{} of {} x {}\n", report["pixel"][0].get<int>(),
                                   report["pixel"][1].get<int>(), report["frame"][0].get<int>(),
                                   report["frame"][1].get<int>());
    text += fmt::format("position      {} m, {} from the camera\n", vector_text(report["position"]),
                        metres_text(report["camera_distance"]));
    text += fmt::format("normals       geometric {}; shading {}\n", vector_text(report["geometric_normal"]),
                        vector_text(report["shading_normal"]));
    text += fmt::format("material      \"{}\"\n", one_line(report["material"].get<std::string>()));
    for (const Json& record : report["records"]) text += record_text(record);
    text += fmt::format("gap rays      {}\n", report["gap_rays"].get<std::size_t>());
    const Json& outgoing = report["outgoing_radiance"];
    text += fmt::format("radiance      {} estimated\n", vector_text(outgoing["estimate"]));
    text += fmt::format("              {} from the true hemisphere\n",
                        vector_text(outgoing["from_true_hemisphere"]));
    text += fmt::format("error         {} in covered bits\n", vector_text(outgoing["error_of_covered_bits"]));
    text += fmt::format("              {} in gaps\n", vector_text(outgoing["error_of_gap_bits"]));
    for (const auto& [picture, scale] : report["picture_scales"].items())
        text +=
            fmt::format("full colour   {:.4g} in {}\n", scale.get<double>(), picture_file(options, picture));
    return text;
}

}  // namespace

ExitCode run_inspect(const Arguments& arguments) {
    CLI::App app(
        "Shows what the radiance cache does for one pixel: a picture of every step in DIR, and a report.",
        "relumine inspect");
    Options options;
    options.settings.method = "reproject";
    options.settings.samples_per_pixel = 1;
    add_options(app, options);
    app.footer(
        "Pictures: record, layers, surfels, reprojected, masks, gap_rays, filled, bsdf, product, truth, "
        "error; what "
        "they show: docs/command.md.\nExit codes: 0 done; 1 bad input or failed output; 2 bad usage.");
    if (!parse(app, arguments)) return ExitCode::done;

    validate(options.settings);
    check_writable(picture_file(options, "record"));
    const Scene scene = load_scene(options.scene, options.scene_options);
    for (const std::string& warning : scene.info().warnings) print_line("relumine: warning: " + warning);
    const Inspection inspection = inspect(scene, options.settings, options.pixel.x, options.pixel.y);
    save(inspection, options);
    print(options.json ? inspection.report_json + "\n"
                       : report_text(Json::parse(inspection.report_json), options));
    return ExitCode::done;
}

}  // namespace relumine::cli
