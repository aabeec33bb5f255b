// SPDX-License-Identifier: Apache-2.0
// Builds scenes from memory. Descriptions are stored as they come; build() validates them all.
#include <fmt/format.h>

#include <algorithm>

#include "base/assert.hpp"
#include "relumine/scene.hpp"
#include "scene/finish_scene.hpp"

namespace relumine {
namespace {

Vec3 to_vec3(const std::array<float, 3>& a) { return {a[0], a[1], a[2]}; }
Spectrum to_spectrum(const std::array<float, 3>& a) { return {a[0], a[1], a[2]}; }

/// An id that stays out of range if `i` is.
template <typename Id>
Id to_id(std::size_t i) {
    return static_cast<Id>(std::min<std::size_t>(i, 0xffffffffu));
}

}  // namespace

SceneBuilder::SceneBuilder() : data_(std::make_unique<SceneData>()) { data_->name = "scene"; }
SceneBuilder::~SceneBuilder() = default;
SceneBuilder::SceneBuilder(SceneBuilder&&) noexcept = default;
SceneBuilder& SceneBuilder::operator=(SceneBuilder&&) noexcept = default;

std::size_t SceneBuilder::add_material(const MaterialDescription& material) {
    RELUMINE_ASSERT(data_ != nullptr);
    Material m;
    m.name = material.name.empty() ? fmt::format("material {}", data_->materials.size()) : material.name;
    m.base_color = to_spectrum(material.base_color);
    m.metallic = material.metallic;
    m.roughness = material.roughness;
    m.emission = to_spectrum(material.emission);
    m.double_sided = material.double_sided;
    m.ior = material.ior;
    m.specular = material.specular;
    m.transmission = material.transmission;
    m.solid = material.solid;
    data_->materials.push_back(std::move(m));
    return data_->materials.size() - 1;
}

std::size_t SceneBuilder::add_mesh(const MeshDescription& mesh) {
    RELUMINE_ASSERT(data_ != nullptr);
    Mesh m;
    m.name = mesh.name.empty() ? fmt::format("mesh {}", data_->meshes.size()) : mesh.name;
    std::ranges::transform(mesh.positions, std::back_inserter(m.positions), to_vec3);
    std::ranges::transform(mesh.normals, std::back_inserter(m.normals), to_vec3);
    for (const auto& [u, v] : mesh.uvs) m.uvs[0].push_back({u, v});
    for (const auto& triangle : mesh.triangles) m.triangles.push_back({triangle});
    m.material = to_id<MaterialId>(mesh.material);
    data_->meshes.push_back(std::move(m));
    return data_->meshes.size() - 1;
}

void SceneBuilder::add_instance(std::size_t mesh, const Matrix4& world_from_object) {
    RELUMINE_ASSERT(data_ != nullptr);
    data_->instances.push_back({to_id<MeshId>(mesh), transform_from_columns(world_from_object), false});
}

void SceneBuilder::add_light(const PointLightDescription& light) {
    RELUMINE_ASSERT(data_ != nullptr);
    data_->point_lights.push_back({to_vec3(light.position), to_spectrum(light.intensity)});
}

void SceneBuilder::add_light(const DirectionalLightDescription& light) {
    RELUMINE_ASSERT(data_ != nullptr);
    data_->directional_lights.push_back({normalize(to_vec3(light.direction)), to_spectrum(light.irradiance)});
}

void SceneBuilder::add_camera(const CameraDescription& camera) {
    RELUMINE_ASSERT(data_ != nullptr);
    Camera c;
    c.name = camera.name.empty() ? fmt::format("camera {}", data_->cameras.size()) : camera.name;
    c.world_from_camera = transform_from_columns(camera.world_from_camera);
    c.orthographic = camera.orthographic_height > 0;
    c.vertical_extent = c.orthographic ? camera.orthographic_height : camera.vertical_fov;
    c.aspect = camera.aspect;
    data_->cameras.push_back(std::move(c));
}

void SceneBuilder::set_environment(int width, int height, std::span<const float> rgb) {
    RELUMINE_ASSERT(data_ != nullptr);
    Environment environment{width, height, {}, 0};
    const auto value = [&](std::size_t i) { return i < rgb.size() ? rgb[i] : 0.0f; };
    for (std::size_t i = 0; i < rgb.size();
         i += 3)  // an incomplete texel makes one too many, which build() refuses
        environment.radiance.emplace_back(value(i), value(i + 1), value(i + 2));
    data_->environment = std::move(environment);
}

Scene SceneBuilder::build() {
    RELUMINE_ASSERT(data_ != nullptr);
    SceneData scene = std::move(*data_);
    *this = SceneBuilder{};
    return Scene{std::make_shared<const SceneData>(finish_scene(std::move(scene)))};
}

}  // namespace relumine
