// SPDX-License-Identifier: Apache-2.0
// Loads scenes by the file's extension, applies the options, and tells what a scene holds.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <filesystem>

#include "base/message.hpp"
#include "relumine/error.hpp"
#include "relumine/scene.hpp"
#include "scene/finish_scene.hpp"
#include "scene/quote.hpp"
#include "scene/readers.hpp"
#include "scene/texture_budget.hpp"

namespace relumine {
namespace {

using MeshReader = Mesh (*)(const std::string& path, std::vector<std::string>& warnings);

SceneData read_model(const std::string& path, MeshReader read) {
    std::vector<std::string> warnings;
    SceneData scene = stage_model(read(path, warnings));
    scene.name = path;
    for (std::string& warning : warnings) scene.warn(std::move(warning));
    return scene;
}

/// The part of the file name behind its first dot counts for packed files, else that behind the last; lower
/// case.
bool has_extension(const std::string& path, const std::string& extension) {
    std::string name = std::filesystem::path{path}.filename().string();
    std::ranges::transform(name, name.begin(),
                           [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return name.ends_with(extension);
}

SceneData read_by_extension(const std::string& path, const SceneOptions& options) {
    if (has_extension(path, ".xml")) return read_mitsuba(path, options);
    if (!options.definitions.empty())
        throw SettingsError{
            expected_found("definitions", "a Mitsuba scene, whose parameters they set", path)};
    if (has_extension(path, ".gltf") || has_extension(path, ".glb")) return read_gltf(path, options);
    if (has_extension(path, ".pbrt") || has_extension(path, ".pbrt.gz")) return read_pbrt(path, options);
    if (has_extension(path, ".ply") || has_extension(path, ".ply.gz")) return read_model(path, read_ply);
    if (has_extension(path, ".obj") || has_extension(path, ".obj.gz")) return read_model(path, read_obj);
    const std::array<std::string, 9> known{".gltf", ".glb",    ".pbrt", ".pbrt.gz", ".xml",
                                           ".ply",  ".ply.gz", ".obj",  ".obj.gz"};
    throw SceneError{expected_found(path, "a scene file that ends in " + one_of(known), "another ending")};
}

void check_options(const SceneOptions& options) {
    for (const std::string& folder : options.allowed_folders) {
        std::error_code error;
        if (!std::filesystem::is_directory(folder, error))
            throw SettingsError{expected_found("allowed folder", "an existing folder", quote(folder))};
    }
    if (!(options.environment_scale >= 0) || !std::isfinite(options.environment_scale))
        throw SettingsError{expected_found("environment scale", "a finite number of at least 0",
                                           fmt::format("{:g}", options.environment_scale))};
    if (!std::isfinite(options.environment_rotation_degrees))
        throw SettingsError{expected_found("environment rotation", "a finite number of degrees",
                                           fmt::format("{:g}", options.environment_rotation_degrees))};
}

/// glTF's textures fit from the beginning, since there may be many; the others' are made to fit here.
void fit_textures(SceneData& scene, const SceneOptions& options) {
    TextureBudget budget(options.texture_limit);
    for (std::size_t i = 0; i < scene.images.size(); ++i) budget.add(scene.images, i);
    if (std::string warning = budget.warning(); !warning.empty()) scene.warn(std::move(warning));
}

void apply_environment(SceneData& scene, const SceneOptions& options) {
    if (!options.environment.empty()) {
        std::vector<std::string> warnings;
        scene.environment = read_environment(options.environment, warnings);
        for (std::string& warning : warnings) scene.warn(std::move(warning));
    }
    const bool changes = options.environment_scale != 1 || options.environment_rotation_degrees != 0;
    if (!scene.environment) {
        if (changes) scene.warn("there is no environment that could be scaled or rotated");
        return;
    }
    const double degrees = std::remainder(static_cast<double>(options.environment_rotation_degrees), 360);
    scene.environment->rotation += static_cast<float>(degrees * 3.14159265358979324 / 180);
    if (options.environment_scale == 1) return;
    for (Spectrum& texel : scene.environment->radiance) texel *= options.environment_scale;
}

template <typename T>
std::size_t bytes_of(const std::vector<T>& values) {
    return values.capacity() * sizeof(T);
}

std::size_t mesh_bytes(const Mesh& mesh) {
    return bytes_of(mesh.positions) + bytes_of(mesh.normals) + bytes_of(mesh.tangents) + bytes_of(mesh.uvs[0])
           + bytes_of(mesh.uvs[1]) + bytes_of(mesh.colors) + bytes_of(mesh.triangles);
}

std::size_t scene_bytes(const SceneData& scene) {
    std::size_t bytes = scene.environment ? bytes_of(scene.environment->radiance) : 0;
    for (const Mesh& mesh : scene.meshes) bytes += mesh_bytes(mesh);
    for (const ByteImage& image : scene.images) bytes += bytes_of(image.rgba8) + bytes_of(image.rgba16);
    return bytes + bytes_of(scene.instances);
}

void count_triangles(const SceneData& scene, SceneInfo& info) {
    for (const Mesh& mesh : scene.meshes) info.triangles += mesh.triangles.size();
    for (const Instance& instance : scene.instances) {
        const Mesh& mesh = scene.meshes[index(instance.mesh)];
        info.instanced_triangles += mesh.triangles.size();
        if (!is_black(scene.materials[index(mesh.material)].emission))
            info.emissive_triangles += mesh.triangles.size();
    }
}

}  // namespace

Scene load_scene(const std::string& path, const SceneOptions& options) {
    check_options(options);
    SceneData scene = read_by_extension(path, options);
    if (!has_extension(path, ".gltf") && !has_extension(path, ".glb")) fit_textures(scene, options);
    apply_environment(scene, options);
    return Scene{std::make_shared<const SceneData>(finish_scene(std::move(scene)))};
}

SceneInfo Scene::info() const {
    const SceneData& scene = data();
    SceneInfo info;
    info.meshes = scene.meshes.size();
    info.instances = scene.instances.size();
    count_triangles(scene, info);
    info.materials = scene.materials.size();
    info.textures = scene.images.size();
    info.point_lights = scene.point_lights.size();
    info.spot_lights = scene.spot_lights.size();
    info.directional_lights = scene.directional_lights.size();
    info.has_environment = scene.environment.has_value();
    for (const Camera& camera : scene.cameras) info.cameras.push_back(camera.name);
    info.bounds_min = {scene.bounds.lower.x, scene.bounds.lower.y, scene.bounds.lower.z};
    info.bounds_max = {scene.bounds.upper.x, scene.bounds.upper.y, scene.bounds.upper.z};
    info.memory_bytes = scene_bytes(scene);
    info.warnings = scene.warnings;
    return info;
}

}  // namespace relumine
