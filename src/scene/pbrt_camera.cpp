// SPDX-License-Identifier: Apache-2.0
// pbrt's cameras and films.
#include "scene/pbrt_camera.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/message.hpp"
#include "scene/pbrt_transform.hpp"
#include "scene/quote.hpp"

namespace relumine {
namespace {

constexpr double pi_d = 3.14159265358979323846;
constexpr int max_side = 65536;

/// pbrt's screen window: x from left to right, y from bottom to top, ±1 along the shorter axis.
struct Screen {
    double left, right, bottom, top;
};

struct FilmSize {
    int width, height;
    std::optional<PixelRect> crop;
};

PixelRect crop_rect(const PbrtParameters& p, int width, int height, const std::vector<double>& values,
                    bool relative) {
    const double w = relative ? width : 1, h = relative ? height : 1;
    const auto pixel = [](double x) { return static_cast<int>(std::ceil(std::clamp(x, 0.0, 65536.0))); };
    const PixelRect r{pixel(values[0] * w), pixel(values[2] * h), std::min(pixel(values[1] * w), width),
                      std::min(pixel(values[3] * h), height)};
    if (r.empty())
        p.refuse(relative ? "cropwindow" : "pixelbounds", "a window that holds pixels: x0 x1 y0 y1",
                 fmt::format("{:g} {:g} {:g} {:g}", values[0], values[1], values[2], values[3]));
    return r;
}

FilmSize film_size(const PbrtScene& scene) {
    if (!scene.film) return {1280, 720, {}};
    const PbrtParameters& p = scene.film->parameters;
    FilmSize size{p.integer("xresolution", 1280), p.integer("yresolution", 720), {}};
    for (const int side : {size.width, size.height})
        if (side < 1 || side > max_side)
            p.refuse(side == size.width ? "xresolution" : "yresolution",
                     fmt::format("1 to {} pixels", max_side), fmt::format("{}", side));
    const std::vector<double> window = p.numbers("float", "cropwindow");
    const std::vector<double> bounds = p.numbers("integer", "pixelbounds");
    for (const auto* values : {&window, &bounds})
        if (!values->empty() && values->size() != 4)
            p.refuse(values == &window ? "cropwindow" : "pixelbounds", "four values",
                     fmt::format("{}", values->size()));
    if (!bounds.empty())
        size.crop = crop_rect(p, size.width, size.height, bounds, false);
    else if (!window.empty())
        size.crop = crop_rect(p, size.width, size.height, window, true);
    if (size.crop && size.crop->width() == size.width && size.crop->height() == size.height)
        size.crop.reset();
    return size;
}

Screen screen_window(const PbrtParameters& p, double film_aspect) {
    const double aspect = p.number("frameaspectratio", film_aspect);
    if (!(aspect > 0)) p.refuse("frameaspectratio", "a ratio above 0", fmt::format("{:g}", aspect));
    Screen s = aspect > 1 ? Screen{-aspect, aspect, -1, 1} : Screen{-1, 1, -1 / aspect, 1 / aspect};
    const std::vector<double> window = p.numbers("float", "screenwindow");
    if (window.empty()) return s;
    if (window.size() != 4) p.refuse("screenwindow", "four values", fmt::format("{}", window.size()));
    s = {window[0], window[1], window[2], window[3]};
    if (!(s.left < s.right && s.bottom < s.top))
        p.refuse("screenwindow", "x0 < x1 and y0 < y1",
                 fmt::format("{:g} {:g} {:g} {:g}", s.left, s.right, s.bottom, s.top));
    return s;
}

/// pbrt's camera looks along +Z, ours along −Z; both have +X to the right of the picture and +Y upwards.
Transform our_camera(const PbrtScene& scene) {
    Transform t = inverse(scene.camera_from_world).value_or(Transform{});
    for (auto& row : t.m) row[2] = -row[2];
    return t;
}

void warn_of_bent_axes(PbrtScene& scene, const PbrtPlace& place) {
    const auto& m = scene.camera_from_world.m;
    const auto dot = [&](std::size_t i, std::size_t j) {
        return m[i][0] * m[j][0] + m[i][1] * m[j][1] + m[i][2] * m[j][2];
    };
    const double size = dot(0, 0) + dot(1, 1) + dot(2, 2);
    const double bent = std::abs(dot(0, 1)) + std::abs(dot(1, 2)) + std::abs(dot(2, 0))
                        + std::abs(dot(0, 0) - dot(1, 1)) + std::abs(dot(1, 1) - dot(2, 2));
    if (bent > 1e-3 * size)
        scene.warn(place, "the camera's transform stretches its axes; the stretch is not rendered");
}

void set_lens(const PbrtParameters& p, Camera& camera) {
    camera.lens_radius = p.number("lensradius", 0);
    camera.focus_distance = p.number("focaldistance", 1e6);
    if (!(camera.lens_radius >= 0)) p.refuse("lensradius", "a radius of at least 0", "less");
    if (!(camera.focus_distance > 0)) p.refuse("focaldistance", "a distance above 0", "less");
}

void set_projection(const PbrtEntity& entity, Camera& camera) {
    const PbrtParameters& p = entity.parameters;
    const double film_aspect = static_cast<double>(camera.width) / camera.height;
    const Screen s = screen_window(p, film_aspect);
    const double half_height = (s.top - s.bottom) / 2, half_width = (s.right - s.left) / 2;
    camera.stretch = half_width / half_height / film_aspect;
    camera.shift_x = (s.left + s.right) / 2 / half_height;
    camera.shift_y = (s.bottom + s.top) / 2 / half_height;
    set_lens(p, camera);
    camera.orthographic = entity.type == "orthographic";
    if (camera.orthographic) {
        camera.vertical_extent = 2 * half_height;
        return;
    }
    const double fov = p.number("fov", 90);
    if (!(fov > 0 && fov < 180))
        p.refuse("fov", "an angle between 0 and 180 degrees", fmt::format("{:g}", fov));
    camera.vertical_extent = 2 * std::atan(std::tan(fov * pi_d / 360) * half_height);
}

void set_panorama(const PbrtEntity& entity, Camera& camera) {
    const PbrtParameters& p = entity.parameters;
    const std::vector<std::string> mappings{"equalarea", "equirectangular"};
    const std::string mapping = p.string("mapping", "equalarea");
    if (std::ranges::find(mappings, mapping) == mappings.end())
        p.refuse("mapping", "the mapping " + one_of(mappings),
                 quote(mapping) + did_you_mean(mapping, mappings));
    camera.panorama = mapping == "equalarea" ? Panorama::equal_area : Panorama::lat_long;
    p.ignore({"lensradius", "focaldistance", "frameaspectratio", "screenwindow"});
}

}  // namespace

Camera make_pbrt_camera(PbrtScene& scene) {
    const FilmSize size = film_size(scene);
    static const PbrtEntity standard{"perspective", {}};
    const PbrtEntity& entity = scene.camera ? *scene.camera : standard;
    const PbrtParameters& p = entity.parameters;
    const std::vector<std::string> types{"perspective", "orthographic", "spherical", "realistic"};
    Camera camera;
    camera.name = entity.type;
    camera.width = size.width;
    camera.height = size.height;
    camera.crop = size.crop;
    camera.aspect = static_cast<double>(size.width) / size.height;
    camera.world_from_camera = our_camera(scene);
    warn_of_bent_axes(scene, p.place());
    if (entity.type == "perspective" || entity.type == "orthographic") {
        set_projection(entity, camera);
    } else if (entity.type == "spherical") {
        set_panorama(entity, camera);
    } else if (entity.type == "realistic") {
        scene.warn(p.place(), "camera \"realistic\" is read as a pinhole of 45 degrees");
        camera.vertical_extent = pi_d / 4;
        p.ignore({"lensfile", "aperturediameter", "focusdistance", "aperture"});
    } else {
        refuse_pbrt(p.place(), "a camera among " + one_of(types),
                    quote(entity.type) + did_you_mean(entity.type, types));
    }
    p.ignore({"shutteropen", "shutterclose"});
    p.finish();
    return camera;
}

double pbrt_imaging_ratio(PbrtScene& scene) {
    double exposure_time = 1;
    if (scene.camera) {
        const PbrtParameters& p = scene.camera->parameters;
        exposure_time = std::abs(p.number("shutterclose", 1) - p.number("shutteropen", 0));
        if (!(exposure_time > 0)) p.refuse("shutterclose", "a shutter that opens", "a time of 0");
    }
    if (!scene.film) return exposure_time;
    const PbrtParameters& p = scene.film->parameters;
    const std::vector<std::string> types{"rgb", "gbuffer", "spectral"};
    if (std::ranges::find(types, scene.film->type) == types.end())
        refuse_pbrt(p.place(), "a film among " + one_of(types),
                    quote(scene.film->type) + did_you_mean(scene.film->type, types));
    const double iso = p.number("iso", 100);
    if (!(iso > 0)) p.refuse("iso", "a sensitivity above 0", fmt::format("{:g}", iso));
    const std::string sensor = p.string("sensor", "cie1931");
    if (sensor != "cie1931")
        scene.warn(p.place(), fmt::format("sensor {} is read as \"cie1931\"", quote(sensor)));
    if (p.number("whitebalance", 0) != 0)
        scene.warn(p.place(), "\"whitebalance\" is not supported: colours are as the lights are");
    if (p.has("maxcomponentvalue"))
        scene.warn(p.place(), "\"maxcomponentvalue\" is not supported: radiance is never clamped");
    p.ignore({"maxcomponentvalue", "filename", "diagonal", "savefp16", "coordinatesystem", "lambdamin",
              "lambdamax", "nbuckets"});
    p.finish();
    return exposure_time * iso / 100;
}

}  // namespace relumine
