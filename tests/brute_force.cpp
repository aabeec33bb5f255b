// SPDX-License-Identifier: Apache-2.0
// Light transport by brute force.
#include "tests/brute_force.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace relumine::testing {
namespace {

constexpr double pi = 3.14159265358979323846;

Triple operator+(const Triple& a, const Triple& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
Triple operator-(const Triple& a, const Triple& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Triple operator*(const Triple& a, const Triple& b) { return {a[0] * b[0], a[1] * b[1], a[2] * b[2]}; }
Triple operator*(double s, const Triple& a) { return {s * a[0], s * a[1], s * a[2]}; }
double dot(const Triple& a, const Triple& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Triple cross(const Triple& a, const Triple& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
double length(const Triple& a) { return std::sqrt(dot(a, a)); }
Triple unit(const Triple& a) { return (1 / length(a)) * a; }
double mean(const Triple& a) { return (a[0] + a[1] + a[2]) / 3; }

struct Hit {
    const Panel* panel = nullptr;
    double distance = std::numeric_limits<double>::infinity();
};

/// The first panel that origin + t · direction meets, t > 0.
Hit first_hit(const std::vector<Panel>& panels, const Triple& origin, const Triple& direction) {
    constexpr double nearest = 1e-9;
    Hit hit;
    for (const Panel& panel : panels) {
        const Triple normal = cross(panel.u, panel.v), from_corner = origin - panel.corner;
        const double t = -dot(from_corner, normal) / dot(direction, normal);
        if (!(t > nearest && t < hit.distance)) continue;
        const Triple at = from_corner + t * direction;
        const double area2 = dot(normal, normal);
        const double a = dot(cross(at, panel.v), normal) / area2, b = dot(cross(panel.u, at), normal) / area2;
        if (a >= 0 && a <= 1 && b >= 0 && b <= 1) hit = {&panel, t};
    }
    return hit;
}

/// f, without the cosine, of `panel` for directions on the side of the unit `normal`.
Triple reflected(const Panel& panel, const Triple& normal, const Triple& w_out, const Triple& w_in) {
    if (panel.alpha == 0) return (1 / pi) * panel.colour;
    const double cos_out = dot(normal, w_out), cos_in = dot(normal, w_in), a2 = panel.alpha * panel.alpha;
    const Triple half = unit(w_out + w_in);
    const double c = dot(normal, half), denominator = c * c * (a2 - 1) + 1;
    const double distribution = a2 / (pi * denominator * denominator);
    const auto lambda = [&](double cosine) {  // Smith's, of GGX
        return (std::sqrt(1 + a2 * (1 - cosine * cosine) / (cosine * cosine)) - 1) / 2;
    };
    const double masking = 1 / (1 + lambda(cos_out) + lambda(cos_in));
    const double schlick = std::pow(1 - dot(half, w_out), 5);
    const Triple fresnel = panel.colour + schlick * (Triple{1, 1, 1} - panel.colour);
    return (distribution * masking / (4 * cos_out * cos_in)) * fresnel;
}

/// In proportion to the cosine with `normal`: a point of the sphere that touches the surface.
Triple cosine_direction(const Triple& normal, std::mt19937_64& random) {
    std::uniform_real_distribution<double> uniform;
    const double z = 2 * uniform(random) - 1, phi = 2 * pi * uniform(random), r = std::sqrt(1 - z * z);
    return unit(normal + Triple{r * std::cos(phi), r * std::sin(phi), z});
}

/// What the point light adds at `x`.
Triple from_lamp(const BruteForceScene& scene, const Panel& panel, const Triple& x, const Triple& normal,
                 const Triple& w_out) {
    const Triple way = scene.lamp - x, w_in = unit(way);
    const double cosine = dot(normal, w_in);
    if (mean(scene.lamp_intensity) == 0 || cosine <= 0 || first_hit(scene.panels, x, way).distance < 1)
        return {};
    return (cosine / dot(way, way)) * scene.lamp_intensity * reflected(panel, normal, w_out, w_in);
}

Triple path(const BruteForceScene& scene, Triple origin, Triple direction, std::mt19937_64& random) {
    constexpr double negligible = 1e-4;
    Triple radiance{}, throughput{1, 1, 1};
    while (std::ranges::max(throughput) > negligible) {
        const Hit hit = first_hit(scene.panels, origin, direction);
        if (!hit.panel) return radiance + throughput * scene.sky;
        radiance = radiance + throughput * hit.panel->emission;
        const Triple w_out = -1.0 * direction;
        Triple normal = unit(cross(hit.panel->u, hit.panel->v));
        if (dot(normal, w_out) < 0) normal = -1.0 * normal;
        origin = origin + hit.distance * direction;
        radiance = radiance + throughput * from_lamp(scene, *hit.panel, origin, normal, w_out);
        direction = cosine_direction(normal, random);
        throughput = pi * throughput * reflected(*hit.panel, normal, w_out, direction);
    }
    return radiance;
}

Triple camera_direction(const BruteForceScene& scene, int side, int x, int y) {
    const auto at = [&](int pixel) { return scene.extent * (2 * (pixel + 0.5) / side - 1); };
    return unit({at(x), -at(y), -1});
}

/// Means of blocks of a picture whose pixels are `radiance(x, y)`.
template <typename Radiance>
std::vector<double> means_of_blocks(int side, int block, const Radiance& radiance) {
    const int columns = side / block;
    std::vector<double> means(static_cast<std::size_t>(columns * columns));
    for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x)
            means[static_cast<std::size_t>(y / block * columns + x / block)] +=
                mean(radiance(x, y)) / (block * block);
    return means;
}

std::array<float, 3> to_floats(const Triple& a) {
    return {static_cast<float>(a[0]), static_cast<float>(a[1]), static_cast<float>(a[2])};
}

void add(SceneBuilder& builder, const Panel& panel) {
    const std::array positions{to_floats(panel.corner), to_floats(panel.corner + panel.u),
                               to_floats(panel.corner + panel.u + panel.v),
                               to_floats(panel.corner + panel.v)};
    constexpr std::array<std::array<std::uint32_t, 3>, 2> triangles{{{0, 1, 2}, {0, 2, 3}}};
    MaterialDescription material;
    material.base_color = to_floats(panel.colour);
    material.emission = to_floats(panel.emission);
    material.double_sided = true;
    material.specular = 0;
    material.metallic = panel.alpha > 0 ? 1 : 0;
    material.roughness = panel.alpha > 0 ? static_cast<float>(std::sqrt(panel.alpha)) : 1;
    MeshDescription mesh;
    mesh.positions = positions;
    mesh.triangles = triangles;
    mesh.material = builder.add_material(material);
    builder.add_instance(builder.add_mesh(mesh));
}

}  // namespace

Scene build(const BruteForceScene& scene) {
    SceneBuilder builder;
    for (const Panel& panel : scene.panels) add(builder, panel);
    if (mean(scene.lamp_intensity) > 0)
        builder.add_light(PointLightDescription{to_floats(scene.lamp), to_floats(scene.lamp_intensity)});
    if (mean(scene.sky) > 0) {
        const auto [r, g, b] = to_floats(scene.sky);
        builder.set_environment(2, 1, std::array{r, g, b, r, g, b});
    }
    CameraDescription camera;
    camera.vertical_fov = 2 * std::atan(scene.extent);
    std::ranges::copy(scene.eye, camera.world_from_camera.begin() + 12);
    builder.add_camera(camera);
    return builder.build();
}

std::vector<double> brute_force_blocks(const BruteForceScene& scene, int side, int block, int paths,
                                       std::uint32_t seed) {
    std::mt19937_64 random{seed};
    return means_of_blocks(side, block, [&](int x, int y) {
        Triple sum{};
        for (int i = 0; i < paths; ++i)
            sum = sum + path(scene, scene.eye, camera_direction(scene, side, x, y), random);
        return (1.0 / paths) * sum;
    });
}

std::vector<double> lit_by_polygon_blocks(const BruteForceScene& scene, const Panel& receiver,
                                          const Panel& lamp, int side, int block) {
    const std::array corners{lamp.corner, lamp.corner + lamp.u, lamp.corner + lamp.u + lamp.v,
                             lamp.corner + lamp.v};
    return means_of_blocks(side, block, [&](int x, int y) {
        const Triple direction = camera_direction(scene, side, x, y);
        const Triple at = scene.eye + first_hit({receiver}, scene.eye, direction).distance * direction;
        Triple sum{};  // of the edges' angles, each along the normal of its triangle with `at`
        for (std::size_t i = 0; i < corners.size(); ++i) {
            const Triple a = unit(corners[i] - at), b = unit(corners[(i + 1) % corners.size()] - at);
            sum = sum + std::acos(std::clamp(dot(a, b), -1.0, 1.0)) * unit(cross(a, b));
        }
        const double form =
            std::abs(dot(sum, unit(cross(receiver.u, receiver.v)))) / 2;  // irradiance / radiance
        return receiver.emission + (form / pi) * receiver.colour * lamp.emission;
    });
}

}  // namespace relumine::testing
