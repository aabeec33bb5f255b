// SPDX-License-Identifier: Apache-2.0
// Lights and cameras of a glTF file.
#include "scene/gltf_lights.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/message.hpp"
#include "relumine/error.hpp"
#include "scene/quote.hpp"

namespace relumine {
namespace {

using Vector = std::array<double, 3>;

Vector column(const Transform& t, std::size_t j) { return {t.m[0][j], t.m[1][j], t.m[2][j]}; }
Vector cross(const Vector& a, const Vector& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
double length(const Vector& a) { return std::hypot(a[0], a[1], a[2]); }

/// The unit vector along `a`. Fails where the node's scale has made `a` vanish.
Vector direction(const Vector& a, const GltfFile& file, const PlacedNode& placed) {
    const double l = length(a);
    if (!(l > 1e-30 && l < 1e30))
        throw SceneError{expected_found(file.where(fmt::format("nodes[{}]", placed.node)),
                                        "a transform that keeps directions",
                                        fmt::format("an axis of length {:g}", l))};
    return {a[0] / l, a[1] / l, a[2] / l};
}

Vec3 to_vec3(const Vector& a) {
    return {static_cast<float>(a[0]), static_cast<float>(a[1]), static_cast<float>(a[2])};
}

/// Lights shine along −Z of their node.
Vec3 light_axis(const GltfFile& file, const PlacedNode& placed) {
    return -to_vec3(direction(column(placed.world_from_node, 2), file, placed));
}

/// Candela (or lux) taken as W·sr⁻¹ (or W·m⁻²) per channel.
Spectrum intensity(const tinygltf::Light& light) {
    const auto channel = [&](std::size_t i) {
        return static_cast<float>((light.color.size() == 3 ? light.color[i] : 1.0) * light.intensity);
    };
    return {channel(0), channel(1), channel(2)};
}

SpotLight spot_light(const GltfFile& file, const PlacedNode& placed, const tinygltf::Light& light,
                     const std::string& place) {
    const double inner = light.spot.innerConeAngle, outer = light.spot.outerConeAngle;
    if (!(inner < outer))
        throw SceneError{expected_found(file.where(place + ".spot.innerConeAngle"),
                                        fmt::format("less than outerConeAngle = {:g}", outer),
                                        fmt::format("{:g}", inner))};
    return {to_vec3(column(placed.world_from_node, 3)), light_axis(file, placed), intensity(light),
            static_cast<float>(std::cos(inner)), static_cast<float>(std::cos(outer))};
}

/// The node's axes without its scale: a camera looks the same whatever scales its parents.
Transform rigid(const GltfFile& file, const PlacedNode& placed) {
    const Transform& t = placed.world_from_node;
    const Vector z = direction(column(t, 2), file, placed);
    const Vector x = direction(cross(column(t, 1), z), file, placed);
    const Vector y = cross(z, x);
    Transform axes;
    for (std::size_t i = 0; i < 3; ++i) axes.m[i] = {x[i], y[i], z[i], t.m[i][3]};
    return axes;
}

std::string unique_camera_name(const std::string& name, const SceneData& scene) {
    const auto taken = [&](const std::string& candidate) {
        return std::ranges::find(scene.cameras, candidate, &Camera::name) != scene.cameras.end();
    };
    std::string candidate = name;
    for (int n = 2; taken(candidate); ++n) candidate = fmt::format("{} ({})", name, n);
    return candidate;
}

/// The node's name, else the camera's, else its number.
std::string camera_name(const GltfFile& file, const PlacedNode& placed, const SceneData& scene) {
    const auto& node = file.model.nodes[to_size(placed.node)];
    const auto& camera = file.model.cameras[to_size(node.camera)];
    if (!node.name.empty()) return node.name;
    return camera.name.empty() ? fmt::format("camera {}", scene.cameras.size()) : camera.name;
}

void set_projection(const GltfFile& file, const tinygltf::Camera& source, const std::string& place,
                    Camera& camera) {
    camera.orthographic = source.type == "orthographic";
    if (!camera.orthographic) {
        camera.vertical_extent = source.perspective.yfov;
        camera.aspect = source.perspective.aspectRatio;
        return;
    }
    const double width = std::abs(source.orthographic.xmag), height = std::abs(source.orthographic.ymag);
    if (!(width > 0 && height > 0))
        throw SceneError{expected_found(file.where(place + ".orthographic"), "xmag and ymag that are not 0",
                                        fmt::format("{:g} and {:g}", width, height))};
    camera.vertical_extent = 2 * height;
    camera.aspect = width / height;
}

}  // namespace

void add_gltf_light(const GltfFile& file, const PlacedNode& placed, SceneData& scene) {
    const auto& extensions = file.model.nodes[to_size(placed.node)].extensions;
    const auto it = extensions.find("KHR_lights_punctual");
    if (it == extensions.end()) return;
    const int i = it->second.Get("light").GetNumberAsInt();
    const auto& light = file.model.lights[to_size(i)];
    const std::string place = fmt::format("extensions.KHR_lights_punctual.lights[{}]", i);
    const Vec3 position = to_vec3(column(placed.world_from_node, 3));
    if (light.type == "point")
        scene.point_lights.push_back({position, intensity(light)});
    else if (light.type == "spot")
        scene.spot_lights.push_back(spot_light(file, placed, light, place));
    else if (light.type == "directional")
        scene.directional_lights.push_back({light_axis(file, placed), intensity(light)});
    else
        throw SceneError{
            expected_found(file.where(place + ".type"), "point, spot or directional", quote(light.type))};
}

void add_gltf_camera(const GltfFile& file, const PlacedNode& placed, SceneData& scene) {
    const int i = file.model.nodes[to_size(placed.node)].camera;
    if (i < 0) return;
    Camera camera;
    camera.name = unique_camera_name(camera_name(file, placed, scene), scene);
    camera.world_from_camera = rigid(file, placed);
    set_projection(file, file.model.cameras[to_size(i)], fmt::format("cameras[{}]", i), camera);
    scene.cameras.push_back(std::move(camera));
}

}  // namespace relumine
