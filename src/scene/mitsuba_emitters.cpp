// SPDX-License-Identifier: Apache-2.0
// Mitsuba's point, spot, directional and constant emitters, and environment maps.
#include "scene/mitsuba_emitters.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/message.hpp"
#include "relumine/error.hpp"
#include "scene/pbrt_transform.hpp"
#include "scene/quote.hpp"
#include "scene/readers.hpp"

namespace relumine {
namespace {

constexpr double pi_d = 3.14159265358979323846;
using Point = std::array<double, 3>;

const std::vector<std::string> emitter_types{"area", "constant", "directional", "envmap", "point", "spot"};

Point apply(const Transform& t, const Point& p, double w) {
    Point q{};
    for (std::size_t i = 0; i < 3; ++i)
        q[i] = t.m[i][0] * p[0] + t.m[i][1] * p[1] + t.m[i][2] * p[2] + t.m[i][3] * w;
    return q;
}
Vec3 to_vec3(const Point& p) {
    return {static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])};
}

Vec3 unit_direction(const Point& w, MitsubaProperties& p, std::string_view name) {
    const double l = std::hypot(w[0], w[1], w[2]);
    if (!(l > 1e-30 && l < 1e30)) p.refuse(name, "a direction that is not 0", "0 0 0");
    return to_vec3({w[0] / l, w[1] / l, w[2] / l});
}

/// Mitsuba's map has −Z at its left edge, +X a quarter to the right of it: ours a quarter turn on.
Spectrum look_up(const Environment& map, const Point& w) {
    const double l = std::hypot(w[0], w[1], w[2]);
    const double u = std::atan2(w[0], -w[2]) / (2 * pi_d),
                 v = std::acos(std::clamp(w[1] / l, -1.0, 1.0)) / pi_d;
    const double x = (u - std::floor(u)) * map.width - 0.5, y = v * map.height - 0.5;
    const int i = static_cast<int>(std::floor(x)), j = static_cast<int>(std::floor(y));
    const auto texel = [&](int column, int row) {
        const int c = (column % map.width + map.width) % map.width, r = std::clamp(row, 0, map.height - 1);
        return map.radiance[static_cast<std::size_t>(r) * static_cast<std::size_t>(map.width)
                            + static_cast<std::size_t>(c)];
    };
    const auto s = static_cast<float>(x - i), t = static_cast<float>(y - j);
    return lerp(lerp(texel(i, j), texel(i + 1, j), s), lerp(texel(i, j + 1), texel(i + 1, j + 1), s), t);
}

/// The angle about +Y where that is all that the transform does.
std::optional<double> turn_about_y(const Transform& t) {
    const double s = std::sqrt(t.m[0][0] * t.m[0][0] + t.m[0][2] * t.m[0][2]);
    const auto near = [&](double a, double b) { return std::abs(a - b) <= 1e-6 * s; };
    const bool only = s > 0 && near(t.m[0][1], 0) && near(t.m[1][0], 0) && near(t.m[1][2], 0)
                      && near(t.m[2][1], 0) && t.m[1][1] > 0 && near(t.m[0][0], t.m[2][2])
                      && near(t.m[0][2], -t.m[2][0]);
    if (!only) return {};
    return std::atan2(t.m[0][2], t.m[0][0]);
}

/// The map turned by `world_from_map`: means of 4 × 4 bilinear samples per texel.
Environment resampled(const Environment& map, const Transform& map_from_world) {
    constexpr int steps = 4;
    const int height = std::clamp(map.height, 32, 2048), width = 2 * height;
    Environment turned{width, height, {}, 0};
    turned.radiance.reserve(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            Spectrum sum;
            double weights = 0;
            for (int k = 0; k < steps * steps; ++k) {
                const double theta = pi_d * (y + (k / steps + 0.5) / steps) / height;
                const double phi = 2 * pi_d * ((x + (k % steps + 0.5) / steps) / width - 0.5),
                             across = std::sin(theta);
                sum +=
                    look_up(map, apply(map_from_world,
                                       {across * std::cos(phi), std::cos(theta), across * std::sin(phi)}, 0))
                    * static_cast<float>(across);
                weights += across;
            }
            turned.radiance.push_back(sum / static_cast<float>(weights));
        }
    }
    return turned;
}

class EmitterReader {
  public:
    EmitterReader(MitsubaScene& scene, SceneData& out) : scene_(scene), out_(out) {}

    void read(const MitsubaElement& element) {
        MitsubaProperties p(element, scene_);
        p.ignore({"sampling_weight"});
        const std::string& type = element.type;
        if (type == "point")
            point(p);
        else if (type == "spot")
            spot(p);
        else if (type == "directional")
            directional(p);
        else if (type == "constant")
            constant(p);
        else if (type == "envmap")
            envmap(p);
        else if (type == "area")
            refuse_pbrt(element.place, "emitter \"area\" inside of a shape", "it in the scene");
        else
            refuse_pbrt(element.place, "an emitter among " + one_of(emitter_types),
                        quote(type) + did_you_mean(type, emitter_types));
        p.finish();
    }

  private:
    static Point position(MitsubaProperties& p) {
        const Transform t = p.transform("to_world");
        return apply(t, p.vector("position", {0, 0, 0}), 1);
    }
    void point(MitsubaProperties& p) {
        out_.point_lights.push_back(
            {to_vec3(position(p)), mitsuba_color(p, "intensity", Spectrum{1}, MitsubaColorUse::light)});
    }
    void spot(MitsubaProperties& p) {
        const double cutoff = p.number("cutoff_angle", 20), beam = p.number("beam_width", cutoff * 0.75);
        if (!(cutoff > 0 && cutoff < 180 && beam >= 0 && beam <= cutoff))
            p.refuse("cutoff_angle", "an angle of 0 to 180 degrees that is not below \"beam_width\"",
                     fmt::format("{:g} and {:g}", cutoff, beam));
        if (beam < cutoff)
            p.warn("a spot's light falls off by a smooth step between beam_width and cutoff_angle");
        p.unsupported({"texture"}, "an even spot instead");
        const Transform t = p.transform("to_world");
        SpotLight light{to_vec3(apply(t, {0, 0, 0}, 1)),
                        unit_direction(apply(t, {0, 0, 1}, 0), p, "to_world"),
                        mitsuba_color(p, "intensity", Spectrum{1}, MitsubaColorUse::light),
                        static_cast<float>(std::cos(beam * pi_d / 180)),
                        static_cast<float>(std::cos(cutoff * pi_d / 180))};
        light.smoothstep = true;
        out_.spot_lights.push_back(light);
    }
    void directional(MitsubaProperties& p) {
        const Transform t = p.transform("to_world");
        const bool given = p.find("direction") != nullptr;
        const Point w = given ? p.vector("direction", {0, 0, 1}) : apply(t, {0, 0, 1}, 0);
        out_.directional_lights.push_back(
            {unit_direction(w, p, "direction"),
             mitsuba_color(p, "irradiance", Spectrum{1}, MitsubaColorUse::light)});
    }
    void set_environment(Environment environment, MitsubaProperties& p) {
        if (out_.environment) refuse_pbrt(p.object().place, "one environment", "a second one");
        out_.environment = std::move(environment);
    }
    void constant(MitsubaProperties& p) {
        const Spectrum radiance = mitsuba_color(p, "radiance", Spectrum{1}, MitsubaColorUse::light);
        set_environment({2, 1, {radiance, radiance}, 0}, p);
    }
    void envmap(MitsubaProperties& p) {
        const std::string name = p.string("filename", "");
        if (name.empty()) p.refuse("filename", "<string name=\"filename\">", "none");
        const double scale = p.number("scale", 1);
        if (!(scale >= 0)) p.refuse("scale", "a scale of at least 0", fmt::format("{:g}", scale));
        p.ignore({"mis_compensation"});
        const Transform to_world = p.transform("to_world");
        const std::optional<Transform> map_from_world = inverse(to_world);
        if (!map_from_world) p.refuse("to_world", "a transform that can be inverted", "a flat one");
        Environment map = read_map(p, name);
        for (Spectrum& texel : map.radiance) texel *= static_cast<float>(scale);
        if (const std::optional<double> turn = turn_about_y(to_world)) {
            map.rotation = static_cast<float>(std::remainder(*turn - pi_d / 2, 2 * pi_d));
            set_environment(std::move(map), p);
        } else {
            set_environment(resampled(map, *map_from_world), p);
        }
    }
    /// Also of PNG and JPEG, as Mitsuba has it.
    Environment read_map(MitsubaProperties& p, const std::string& name) {
        const PbrtPlace& place = p.object().place;
        std::vector<std::string> warnings;
        Environment map;
        try {
            const std::string path = scene_.files.resolve(name, place);
            std::string ending = path.substr(path.find_last_of('.') + 1);
            std::ranges::transform(ending, ending.begin(),
                                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
            if (ending == "png" || ending == "jpg" || ending == "jpeg") {
                PbrtTextures textures(scene_.notes, scene_.files, out_);
                const auto pixels = textures.pixels(name, "sRGB", place);
                return {pixels->width, pixels->height, pixels->rgb, 0};
            }
            map = read_environment(path, warnings);
        } catch (const ImageError& error) {
            throw SceneError{fmt::format("{}: {}", place.text(), error.what())};
        }
        for (const std::string& warning : warnings) p.warn(warning);
        return map;
    }

    MitsubaScene& scene_;
    SceneData& out_;
};

}  // namespace

void add_mitsuba_emitters(MitsubaScene& scene, const std::vector<const MitsubaElement*>& emitters,
                          SceneData& out) {
    EmitterReader reader(scene, out);
    for (const MitsubaElement* emitter : emitters) reader.read(*emitter);
}

}  // namespace relumine
