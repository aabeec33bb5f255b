// SPDX-License-Identifier: Apache-2.0
// Perspective, thin-lens and orthographic sensors.
#include "scene/mitsuba_sensor.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "base/message.hpp"
#include "scene/pbrt_transform.hpp"
#include "scene/quote.hpp"

namespace relumine {
namespace {

constexpr double pi_d = 3.14159265358979323846;
constexpr int max_side = 65536;

void read_crop(MitsubaProperties& p, Camera& camera) {
    const PixelRect crop{p.integer("crop_offset_x", 0), p.integer("crop_offset_y", 0), 0, 0};
    const int width = p.integer("crop_width", camera.width - std::clamp(crop.x0, 0, camera.width)),
              height = p.integer("crop_height", camera.height - std::clamp(crop.y0, 0, camera.height));
    const bool inside = crop.x0 >= 0 && crop.y0 >= 0 && width >= 1 && height >= 1 && crop.x0 < camera.width
                        && crop.y0 < camera.height && width <= camera.width - crop.x0
                        && height <= camera.height - crop.y0;
    if (!inside)
        p.refuse("crop_width", fmt::format("a crop inside of {} × {} pixels", camera.width, camera.height),
                 fmt::format("{} × {} at {}, {}", width, height, crop.x0, crop.y0));
    if (width == camera.width && height == camera.height) return;
    camera.crop = PixelRect{crop.x0, crop.y0, crop.x0 + width, crop.y0 + height};
}

void read_film(const MitsubaElement& film, MitsubaScene& scene, Camera& camera) {
    MitsubaProperties p(film, scene);
    const std::vector<std::string> types{"hdrfilm", "ldrfilm", "specfilm"};
    if (std::ranges::find(types, film.type) == types.end())
        refuse_pbrt(film.place, "a film among " + one_of(types),
                    quote(film.type) + did_you_mean(film.type, types));
    camera.width = p.integer("width", 768);
    camera.height = p.integer("height", 576);
    for (const char* side : {"width", "height"}) {
        const int pixels = side[0] == 'w' ? camera.width : camera.height;
        if (pixels < 1 || pixels > max_side)
            p.refuse(side, fmt::format("1 to {} pixels", max_side), fmt::format("{}", pixels));
    }
    read_crop(p, camera);
    p.ignore({"file_format", "pixel_format", "component_format", "banner", "compensate", "sample_border",
              "high_quality_edges", "gamma", "exposure"});
    (void)p.objects("rfilter");  // the command's choice
    p.finish();
}

double focal_length_fov(MitsubaProperties& p) {
    std::string text = p.string("focal_length", "50mm");
    if (text.ends_with("mm")) text.resize(text.size() - 2);
    const std::vector<double> mm = mitsuba_numbers(text, p.object().place, "a focal length such as 50mm");
    if (mm.size() != 1 || !(mm[0] > 0)) p.refuse("focal_length", "a length above 0", quote(text));
    return 2 * std::atan(std::hypot(36.0, 24.0) / 2 / mm[0]);  // of the diagonal of a 35 mm film
}

/// The vertical field of view in radians.
double read_fov(MitsubaProperties& p, double aspect) {
    std::string axis = p.choice("fov_axis", {"x", "y", "diagonal", "smaller", "larger"});
    double fov;
    if (p.find("fov")) {
        if (p.find("focal_length")) p.refuse("focal_length", "either \"fov\" or \"focal_length\"", "both");
        const double degrees = p.number("fov", 0);
        if (!(degrees > 0 && degrees < 180))
            p.refuse("fov", "an angle between 0 and 180 degrees", fmt::format("{:g}", degrees));
        fov = degrees * pi_d / 180;
    } else {
        fov = focal_length_fov(p);
        axis = "diagonal";
    }
    const double half = std::tan(fov / 2);
    if (axis == "smaller") axis = aspect > 1 ? "y" : "x";
    if (axis == "larger") axis = aspect > 1 ? "x" : "y";
    if (axis == "y") return fov;
    if (axis == "x") return 2 * std::atan(half / aspect);
    return 2 * std::atan(half / std::hypot(aspect, 1.0));
}

void read_lens(MitsubaProperties& p, Camera& camera) {
    if (!p.find("aperture_radius"))
        p.refuse("aperture_radius", "\"aperture_radius\" of \"thinlens\"", "none");
    camera.lens_radius = p.number("aperture_radius", 0);
    camera.focus_distance = p.number("focus_distance", 0);
    if (!(camera.lens_radius >= 0))
        p.refuse("aperture_radius", "a radius of at least 0", fmt::format("{:g}", camera.lens_radius));
    if (!(camera.focus_distance > 0))
        p.refuse("focus_distance", "a distance above 0", fmt::format("{:g}", camera.focus_distance));
}

/// Mitsuba's sensor looks along +Z with +X to the left; ours along −Z with +X to the right.
Transform our_camera(MitsubaProperties& p, bool orthographic) {
    const Transform world_from_sensor = p.transform("to_world");
    if (!inverse(world_from_sensor))
        p.refuse("to_world", "a sensor transform that can be inverted", "a flat one");
    Transform t = world_from_sensor;
    std::array<double, 3> length{};
    for (std::size_t j = 0; j < 3; ++j) length[j] = std::hypot(t.m[0][j], t.m[1][j], t.m[2][j]);
    const double most = std::max({length[0], length[1], length[2]}),
                 least = std::min({length[0], length[1], length[2]});
    if (most > least * 1.001 && !(orthographic && std::abs(length[0] - length[1]) < 1e-3 * most))
        p.warn("the sensor's to_world stretches its axes; the stretch is not rendered");
    for (auto& row : t.m) {
        row[0] = -row[0];
        row[2] = -row[2];
    }
    return t;
}

void read_sampler(const MitsubaElement& sampler, MitsubaScene& scene) {
    MitsubaProperties p(sampler, scene);
    const int count = p.integer("sample_count", 4);
    p.warn(fmt::format("\"sample_count\" {0} is not taken over: --spp {0} takes as many samples", count));
    p.ignore({"seed", "jitter"});
    p.finish();
}

}  // namespace

Camera make_mitsuba_camera(MitsubaScene& scene, const MitsubaElement& sensor) {
    MitsubaProperties p(sensor, scene);
    const std::vector<std::string> types{"orthographic", "perspective", "thinlens"};
    if (std::ranges::find(types, sensor.type) == types.end())
        refuse_pbrt(sensor.place, "a sensor among " + one_of(types),
                    quote(sensor.type) + did_you_mean(sensor.type, types));
    Camera camera;
    camera.name = sensor.id.empty() ? sensor.type : sensor.id;
    camera.width = 768;
    camera.height = 576;
    camera.orthographic = sensor.type == "orthographic";
    for (const MitsubaElement* film : p.objects("film")) read_film(*film, scene, camera);
    for (const MitsubaElement* sampler : p.objects("sampler")) read_sampler(*sampler, scene);
    camera.aspect = static_cast<double>(camera.width) / camera.height;
    camera.world_from_camera = our_camera(p, camera.orthographic);
    if (camera.orthographic) {
        camera.vertical_extent = 2 / camera.aspect;  // x spans [−1, 1]
    } else {
        camera.vertical_extent = read_fov(p, camera.aspect);
        camera.shift_x = 2 * p.number("principal_point_offset_x", 0) * camera.aspect;
        camera.shift_y = -2 * p.number("principal_point_offset_y", 0);
        if (sensor.type == "thinlens") read_lens(p, camera);
    }
    p.unsupported({"near_clip", "far_clip"}, "everything in front of the camera is seen");
    p.ignore({"shutter_open", "shutter_close", "focus_distance"});
    p.finish();
    return camera;
}

}  // namespace relumine
