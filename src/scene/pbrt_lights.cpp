// SPDX-License-Identifier: Apache-2.0
// pbrt's light sources.
#include "scene/pbrt_lights.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/equal_area.hpp"
#include "base/message.hpp"
#include "relumine/error.hpp"
#include "scene/pbrt_transform.hpp"
#include "scene/quote.hpp"

namespace relumine {
namespace {

constexpr double pi_d = 3.14159265358979323846;
using Point = std::array<double, 3>;

const std::vector<std::string> light_types{"distant", "goniometric", "infinite",
                                           "point",   "projection",  "spot"};

Point apply(const Transform& t, const Point& p, double w) {
    Point q{};
    for (std::size_t i = 0; i < 3; ++i)
        q[i] = t.m[i][0] * p[0] + t.m[i][1] * p[1] + t.m[i][2] * p[2] + t.m[i][3] * w;
    return q;
}
Vec3 to_vec3(const Point& p) {
    return {static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])};
}
double length(const Point& p) { return std::hypot(p[0], p[1], p[2]); }

/// Light from infinity: one colour, or a square image in the light's space.
struct Infinite {
    Spectrum radiance{1};  // times the image
    std::shared_ptr<const PbrtPixels> image;
    Transform light_from_world;
};

class LightReader {
  public:
    LightReader(PbrtScene& scene, PbrtFiles& files, SceneData& out)
        : scene_(scene), files_(files), out_(out), textures_(scene, files, out) {}

    void read(const PbrtLight& light);
    void finish() const;

  private:
    [[nodiscard]] Spectrum color(const PbrtParameters& p, std::string_view name);
    [[nodiscard]] double scale(const PbrtParameters& p) const;
    [[nodiscard]] Vec3 direction(const PbrtLight& light) const;
    [[nodiscard]] Point from(const PbrtLight& light) const;
    void point(const PbrtLight& light);
    void spot(const PbrtLight& light);
    void distant(const PbrtLight& light);
    void infinite(const PbrtLight& light);
    void patterned(const PbrtLight& light);

    PbrtScene& scene_;
    PbrtFiles& files_;
    SceneData& out_;
    PbrtTextures textures_;
    std::vector<Infinite> infinite_;
};

Spectrum LightReader::color(const PbrtParameters& p, std::string_view name) {
    const PbrtParameter* value = p.find_spectrum(name);
    return value ? pbrt_rgb(*value, PbrtSpectrumUse::illuminant, files_) : Spectrum{1};
}

double LightReader::scale(const PbrtParameters& p) const {
    const double scale = p.number("scale", 1);
    if (scale < 0) p.refuse("scale", "a scale of at least 0", fmt::format("{:g}", scale));
    return scale;
}

Point LightReader::from(const PbrtLight& light) const {
    return light.entity.parameters.point("from", {0, 0, 0});
}

/// From "from" to "to", in the world.
Vec3 LightReader::direction(const PbrtLight& light) const {
    const PbrtParameters& p = light.entity.parameters;
    const Point a = from(light), b = p.point("to", {0, 0, 1});
    const Point w = apply(light.world_from_light, {b[0] - a[0], b[1] - a[1], b[2] - a[2]}, 0);
    const double l = length(w);
    if (!(l > 1e-30 && l < 1e30)) p.refuse("to", "a point apart from \"from\"", "the same");
    return to_vec3({w[0] / l, w[1] / l, w[2] / l});
}

void LightReader::point(const PbrtLight& light) {
    const PbrtParameters& p = light.entity.parameters;
    double s = scale(p);
    const double power = p.number("power", -1);
    if (power > 0) s *= power / (4 * pi_d);
    out_.point_lights.push_back(
        {to_vec3(apply(light.world_from_light, from(light), 1)), color(p, "I") * static_cast<float>(s)});
}

void LightReader::spot(const PbrtLight& light) {
    const PbrtParameters& p = light.entity.parameters;
    const double cone = p.number("coneangle", 30), delta = p.number("conedeltaangle", 5);
    if (!(cone > 0 && cone <= 180 && delta >= 0 && delta <= cone))
        p.refuse("coneangle", "an angle of 0 to 180 degrees that is not below \"conedeltaangle\"",
                 fmt::format("{:g} and {:g}", cone, delta));
    const double end = std::cos(cone * pi_d / 180), start = std::cos((cone - delta) * pi_d / 180);
    double s = scale(p);
    const double power = p.number("power", -1);
    if (power > 0) s *= power / (2 * pi_d * ((1 - start) + (start - end) / 2));
    SpotLight spot{to_vec3(apply(light.world_from_light, from(light), 1)), direction(light),
                   color(p, "I") * static_cast<float>(s), static_cast<float>(start), static_cast<float>(end)};
    spot.smoothstep = true;
    out_.spot_lights.push_back(spot);
}

void LightReader::distant(const PbrtLight& light) {
    const PbrtParameters& p = light.entity.parameters;
    double s = scale(p);
    const double illuminance = p.number("illuminance", -1);
    if (illuminance > 0) s *= illuminance;
    out_.directional_lights.push_back({direction(light), color(p, "L") * static_cast<float>(s)});
}

/// Mean of an image of directions, weighted by max(0, z): the illuminance of a ground plane, as pbrt sums it.
double upper_illuminance(const PbrtPixels& image) {
    double sum = 0;
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            const Point w = equal_area_direction((x + 0.5) / image.width, (y + 0.5) / image.height);
            if (w[2] <= 0) continue;
            sum += w[2]
                   * double{
                       luminance(image.rgb[static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width)
                                           + static_cast<std::size_t>(x)])};
        }
    }
    return sum * 2 * pi_d / (double(image.width) * image.height);
}

void check_square(const PbrtPixels& image, const PbrtParameters& p) {
    if (image.width == image.height) return;
    p.refuse("filename", "a square picture in pbrt's equal-area mapping",
             fmt::format("{} × {} pixels", image.width, image.height));
}

void LightReader::infinite(const PbrtLight& light) {
    const PbrtParameters& p = light.entity.parameters;
    Infinite source;
    double s = scale(p);
    const std::string file = p.string("filename", "");
    const double illuminance = p.number("illuminance", -1);
    const bool has_color = p.find_spectrum("L") != nullptr;
    if (p.find("point3", "portal"))
        scene_.warn(p.place(),
                    "the portal of an infinite light is not used: its light comes from everywhere");
    if (has_color && !file.empty()) p.refuse("L", "either \"L\" or \"filename\"", "both");
    double norm = pi_d;
    if (file.empty()) {
        source.radiance = color(p, "L");
    } else {
        source.image = textures_.pixels(file, "sRGB", p.place());
        check_square(*source.image, p);
        if (illuminance > 0) norm = upper_illuminance(*source.image);
    }
    if (illuminance > 0 && norm > 0) s *= illuminance / norm;
    source.radiance *= static_cast<float>(s);
    const std::optional<Transform> inverted = inverse(light.world_from_light);
    if (!inverted) refuse_pbrt(p.place(), "a light transform that can be inverted", "a flat one");
    source.light_from_world = *inverted;
    infinite_.push_back(std::move(source));
}

/// Grey for goniometric lights, as pbrt has it.
std::vector<Spectrum> pattern_factors(const PbrtPixels& image, bool grey) {
    std::vector<Spectrum> factors = image.rgb;
    if (grey)
        for (Spectrum& c : factors) c = Spectrum{(c.r + c.g + c.b) / 3};
    return factors;
}

/// The light that leaves through the picture at intensity 1: its mean luminance over the directions, in sr.
double pattern_solid_angle(const LightPattern& pattern) {
    double sum = 0;
    for (int y = 0; y < pattern.height; ++y) {
        for (int x = 0; x < pattern.width; ++x) {
            const double u = ((x + 0.5) / pattern.width * 2 - 1) * pattern.half_width;
            const double v = ((y + 0.5) / pattern.height * 2 - 1) * pattern.half_height;
            const double weight = pattern.equal_area ? 1 : std::pow(1 + u * u + v * v, -1.5);
            sum += weight
                   * double{luminance(
                       pattern.factor[static_cast<std::size_t>(y) * static_cast<std::size_t>(pattern.width)
                                      + static_cast<std::size_t>(x)])};
        }
    }
    const double whole = pattern.equal_area ? 4 * pi_d : 4 * pattern.half_width * pattern.half_height;
    return whole * sum / (double(pattern.width) * pattern.height);
}

/// Goniometric lights (pbrt turns their pictures so that Y is up) and projectors.
void LightReader::patterned(const PbrtLight& light) {
    const PbrtParameters& p = light.entity.parameters;
    const bool projector = light.entity.type == "projection";
    double s = scale(p);
    const std::string file = p.string("filename", "");
    const double power = p.number("power", -1), fov = projector ? p.number("fov", 90) : 90;
    const Spectrum intensity = projector ? Spectrum{1} : color(p, "I");
    if (file.empty()) p.refuse("filename", "\"string filename\"", "none");
    if (!(fov > 0 && fov < 180))
        p.refuse("fov", "an angle between 0 and 180 degrees", fmt::format("{:g}", fov));
    const auto image = textures_.pixels(file, "sRGB", p.place());
    if (!projector) check_square(*image, p);
    const Transform swap_yz = transform_from_columns({1, 0, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0, 0, 0, 0, 1});
    const std::optional<Transform> light_from_world =
        inverse(projector ? light.world_from_light : light.world_from_light * swap_yz);
    if (!light_from_world) refuse_pbrt(p.place(), "a light transform that can be inverted", "a flat one");
    const double opposite = std::tan(fov * pi_d / 360), aspect = double(image->width) / image->height;
    auto pattern = std::make_shared<LightPattern>(LightPattern{
        *light_from_world, !projector, opposite * std::max(1.0, aspect), opposite * std::max(1.0, 1 / aspect),
        image->width, image->height, pattern_factors(*image, !projector)});
    if (power > 0) s *= power / std::max(1e-30, pattern_solid_angle(*pattern));
    out_.point_lights.push_back({to_vec3(apply(light.world_from_light, {0, 0, 0}, 1)),
                                 intensity * static_cast<float>(s), std::move(pattern)});
}

void LightReader::read(const PbrtLight& light) {
    const std::string& type = light.entity.type;
    const PbrtParameters& p = light.entity.parameters;
    if (type == "point")
        point(light);
    else if (type == "spot")
        spot(light);
    else if (type == "distant")
        distant(light);
    else if (type == "infinite")
        infinite(light);
    else if (type == "goniometric" || type == "projection")
        patterned(light);
    else
        refuse_pbrt(p.place(), "a light among " + one_of(light_types),
                    quote(type) + did_you_mean(type, light_types));
    p.finish();
}

Spectrum look_up(const PbrtPixels& image, Vec2 uv) {
    const auto pixel = [](float c, int size) {
        return static_cast<std::size_t>(
            std::clamp(static_cast<int>(c * static_cast<float>(size)), 0, size - 1));
    };
    return image
        .rgb[pixel(uv.y, image.height) * static_cast<std::size_t>(image.width) + pixel(uv.x, image.width)];
}

/// The mean of an image's radiance over a texel of the lat-long map.
Spectrum lat_long_texel(const Infinite& source, int x, int y, int width, int height, int steps) {
    Spectrum sum;
    double weights = 0;
    for (int j = 0; j < steps; ++j) {
        const double theta = pi_d * (y + (j + 0.5) / steps) / height;
        const double up = std::cos(theta), across = std::sin(theta);
        for (int i = 0; i < steps; ++i) {
            const double phi = 2 * pi_d * ((x + (i + 0.5) / steps) / width - 0.5);
            Point w = apply(source.light_from_world, {across * std::cos(phi), up, across * std::sin(phi)}, 0);
            const double l = length(w);
            for (double& c : w) c /= l;
            sum += look_up(*source.image, equal_area_square(w)) * static_cast<float>(across);
            weights += across;
        }
    }
    return source.radiance * sum / static_cast<float>(weights);
}

void LightReader::finish() const {
    if (infinite_.empty()) return;
    int height = 1;
    for (const Infinite& source : infinite_)
        if (source.image) height = std::max(height, std::clamp(source.image->height, 32, 2048));
    Environment environment{2 * height, height, {}, 0};
    const auto texels = static_cast<std::size_t>(2 * height) * static_cast<std::size_t>(height);
    environment.radiance.assign(texels, {});
    for (const Infinite& source : infinite_) {
        const int steps = !source.image                    ? 1
                          : source.image->height <= 512    ? 8
                          : source.image->height <= height ? 4
                                                           : 2 + 2 * source.image->height / height;
        for (std::size_t i = 0; i < texels; ++i) {
            const int x = static_cast<int>(i) % (2 * height), y = static_cast<int>(i) / (2 * height);
            environment.radiance[i] +=
                source.image ? lat_long_texel(source, x, y, 2 * height, height, steps) : source.radiance;
        }
    }
    out_.environment = std::move(environment);
}

}  // namespace

void add_pbrt_lights(PbrtScene& scene, PbrtFiles& files, SceneData& out) {
    LightReader reader(scene, files, out);
    for (const PbrtLight& light : scene.lights) reader.read(light);
    reader.finish();
}

void scale_lights(SceneData& scene, float factor) {
    if (factor == 1) return;
    for (PointLight& light : scene.point_lights) light.intensity *= factor;
    for (SpotLight& light : scene.spot_lights) light.intensity *= factor;
    for (DirectionalLight& light : scene.directional_lights) light.irradiance *= factor;
    for (Material& material : scene.materials) material.emission *= factor;
    if (scene.environment)
        for (Spectrum& texel : scene.environment->radiance) texel *= factor;
}

}  // namespace relumine
