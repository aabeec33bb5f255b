// SPDX-License-Identifier: Apache-2.0
// A stage for models that come alone: ground, sky and camera.
#include <algorithm>
#include <cmath>

#include "scene/finish_scene.hpp"
#include "scene/mesh_normals.hpp"

namespace relumine {
namespace {

constexpr double field_of_view = 0.7;  // radians, vertical

Bounds3 mesh_bounds(const Mesh& mesh) {
    Bounds3 bounds;
    for (const Triangle& triangle : mesh.triangles)
        for (const std::uint32_t vertex : triangle.vertex)
            if (vertex < mesh.positions.size())
                bounds.add(mesh.positions[vertex]);  // finish_scene refuses the others
    return bounds;
}

bool has_valid_indices(const Mesh& mesh) {
    return std::ranges::all_of(mesh.triangles, [&](const Triangle& triangle) {
        return std::ranges::max(triangle.vertex) < mesh.positions.size();
    });
}

Material clay() {
    Material material;
    material.name = "clay";
    material.base_color = Spectrum{0.6f};
    material.metallic = 0;
    material.roughness = 0.5f;
    return material;
}

Material ground_material() {
    Material material;
    material.name = "ground";
    material.base_color = Spectrum{0.4f};
    material.metallic = 0;
    material.specular = 0;
    return material;
}

/// A horizontal square, far wider than the model and a hair below it.
Mesh ground(const Bounds3& model) {
    const float radius = std::max(model.radius(), 1e-6f);
    const float half = 40 * radius, y = model.lower.y - 1e-4f * radius;
    const Vec3 c = model.center();
    Mesh mesh;
    mesh.name = "ground";
    mesh.positions = {{c.x - half, y, c.z - half},
                      {c.x - half, y, c.z + half},
                      {c.x + half, y, c.z + half},
                      {c.x + half, y, c.z - half}};
    mesh.triangles = {{{0, 1, 2}}, {{0, 2, 3}}};
    mesh.material = MaterialId{1};
    return mesh;
}

/// Radiance of the sky without its sun, from the cosine between a direction and +Y.
Spectrum sky_radiance(float up) {
    constexpr Spectrum zenith{0.35f, 0.55f, 1.0f}, horizon{0.95f, 1.05f, 1.15f}, earth{0.25f, 0.23f, 0.2f};
    if (up < -0.02f) return earth;
    const float height = std::sqrt(std::max(up, 0.0f));
    const Spectrum sky = lerp(horizon, zenith, height);
    return lerp(earth, sky,
                std::clamp((up + 0.02f) / 0.04f, 0.0f, 1.0f));  // no hard edge for the filter to miss
}

/// A soft disc about 6° wide at the upper left in front of the model.
Spectrum sun_radiance(Vec3 direction) {
    const Vec3 sun = normalize(Vec3{-0.55f, 0.65f, 0.55f});
    constexpr float width = 0.05f;  // radians, one standard deviation
    constexpr Spectrum peak{460, 420, 360};
    const float squared_angle = 2 * (1 - dot(direction, sun));
    return peak * std::exp(-squared_angle / (2 * width * width));
}

/// The direction of a texel's centre, as Environment maps it.
Vec3 texel_direction(int x, int y, const Environment& environment) {
    const float phi =
        2 * pi * ((static_cast<float>(x) + 0.5f) / static_cast<float>(environment.width) - 0.5f);
    const float theta = pi * (static_cast<float>(y) + 0.5f) / static_cast<float>(environment.height);
    return {std::sin(theta) * std::cos(phi), std::cos(theta), std::sin(theta) * std::sin(phi)};
}

}  // namespace

Camera framing_camera(const Bounds3& bounds) {
    const Vec3 z = normalize(Vec3{0.35f, 0.3f, 1});  // from the centre to the camera
    const Vec3 x = normalize(cross({0, 1, 0}, z));
    const Vec3 y = cross(z, x);
    const double radius = std::max(static_cast<double>(bounds.radius()), 1e-9);
    const Vec3 center = bounds.center();
    const double distance = 1.05 * radius / std::sin(field_of_view / 2);
    Camera camera;
    camera.name = "framing";
    camera.vertical_extent = field_of_view;
    for (int i = 0; i < 3; ++i)
        camera.world_from_camera.m[static_cast<std::size_t>(i)] = {x[i], y[i], z[i],
                                                                   center[i] + distance * z[i]};
    return camera;
}

SceneData stage_model(Mesh mesh) {
    SceneData scene;
    scene.name = mesh.name;
    scene.materials = {clay(), ground_material()};
    const Bounds3 bounds = mesh_bounds(mesh);
    mesh.material = MaterialId{0};
    if (mesh.normals.empty() && has_valid_indices(mesh)) add_creased_normals(mesh);
    scene.meshes.push_back(std::move(mesh));
    scene.instances.push_back({MeshId{0}, {}, false});
    if (bounds.empty()) return scene;  // finish_scene says what is wrong
    scene.meshes.push_back(ground(bounds));
    scene.instances.push_back({MeshId{1}, {}, false});
    scene.cameras.push_back(framing_camera(bounds));
    scene.environment = builtin_sky();
    return scene;
}

Environment builtin_sky() {
    Environment sky{256, 128, {}, 0};
    for (int y = 0; y < sky.height; ++y) {
        for (int x = 0; x < sky.width; ++x) {
            const Vec3 direction = texel_direction(x, y, sky);
            sky.radiance.push_back(sky_radiance(direction.y) + sun_radiance(direction));
        }
    }
    return sky;
}

}  // namespace relumine
