// SPDX-License-Identifier: Apache-2.0
// From what a reader found to what the renderer can trust: the order of the steps, instances, lights and
// bounds.
#include "scene/finish_scene.hpp"

#include <fmt/format.h>

#include <cmath>

#include "base/message.hpp"
#include "relumine/error.hpp"
#include "scene/check_material.hpp"
#include "scene/finish_mesh.hpp"
#include "scene/quote.hpp"

namespace relumine {
namespace {

constexpr float max_coordinate = 1e18f;  // metres; squares of distances still fit a float

bool is_finite(const Transform& t) {
    for (const auto& row : t.m)
        for (const double x : row)
            if (!std::isfinite(x)) return false;
    return true;
}

/// |det| against the product of the columns' lengths: 1 for orthogonal axes, 0 for flat ones.
bool is_singular(const Transform& t) {
    double lengths = 1;
    for (std::size_t j = 0; j < 3; ++j) lengths *= std::hypot(t.m[0][j], t.m[1][j], t.m[2][j]);
    return !(std::abs(determinant(t)) > 1e-12 * lengths);
}

std::string mesh_where(const SceneData& scene, const Mesh& mesh) {
    return fmt::format("{}: mesh {}", scene.name, quote(mesh.name));
}

void check_instances(const SceneData& scene) {
    for (std::size_t i = 0; i < scene.instances.size(); ++i) {
        const Instance& instance = scene.instances[i];
        const std::string where = fmt::format("{}: instances[{}]", scene.name, i);
        if (index(instance.mesh) >= scene.meshes.size())
            throw SceneError{expected_found(where, fmt::format("a mesh below {}", scene.meshes.size()),
                                            fmt::format("{}", index(instance.mesh)))};
        if (!is_finite(instance.world_from_object))
            throw SceneError{expected_found(where, "a finite transform", "NaN or infinity")};
    }
}

void drop_singular_instances(SceneData& scene) {
    const auto dropped = std::erase_if(
        scene.instances, [](const Instance& instance) { return is_singular(instance.world_from_object); });
    if (dropped > 0) scene.warn(fmt::format("{} instances were scaled flat and were left out", dropped));
}

/// Drops meshes without triangles or without instances, and renumbers the rest.
void drop_unused_meshes(SceneData& scene) {
    std::vector<std::size_t> uses(scene.meshes.size(), 0);
    for (const Instance& instance : scene.instances) ++uses[index(instance.mesh)];
    std::vector<MeshId> new_ids(scene.meshes.size());
    std::vector<bool> keep(scene.meshes.size());
    std::vector<Mesh> kept;
    for (std::size_t i = 0; i < scene.meshes.size(); ++i) {
        keep[i] = uses[i] > 0 && !scene.meshes[i].triangles.empty();
        new_ids[i] = static_cast<MeshId>(kept.size());
        if (keep[i]) kept.push_back(std::move(scene.meshes[i]));
    }
    scene.meshes = std::move(kept);
    std::erase_if(scene.instances, [&](const Instance& instance) { return !keep[index(instance.mesh)]; });
    for (Instance& instance : scene.instances) instance.mesh = new_ids[index(instance.mesh)];
}

void bake_single_instances(SceneData& scene) {
    std::vector<std::size_t> uses(scene.meshes.size(), 0);
    for (const Instance& instance : scene.instances) ++uses[index(instance.mesh)];
    for (Instance& instance : scene.instances) {
        if (uses[index(instance.mesh)] != 1) continue;
        move_to_world(scene.meshes[index(instance.mesh)], instance.world_from_object);
        instance.world_from_object = Transform{};
        instance.identity = true;
    }
}

/// The box that the instance's transform makes of the mesh's box: cheap, and never too small.
Bounds3 instance_bounds(const Bounds3& mesh, const Instance& instance) {
    if (instance.identity) return mesh;
    Bounds3 bounds;
    for (int corner = 0; corner < 8; ++corner)
        bounds.add(instance.world_from_object.point({(corner & 1) != 0 ? mesh.upper.x : mesh.lower.x,
                                                     (corner & 2) != 0 ? mesh.upper.y : mesh.lower.y,
                                                     (corner & 4) != 0 ? mesh.upper.z : mesh.lower.z}));
    return bounds;
}

void compute_bounds(SceneData& scene) {
    std::vector<Bounds3> mesh_bounds(scene.meshes.size());
    for (std::size_t i = 0; i < scene.meshes.size(); ++i)
        for (const Vec3 p : scene.meshes[i].positions) mesh_bounds[i].add(p);
    for (const Instance& instance : scene.instances) {
        const Bounds3 world = instance_bounds(mesh_bounds[index(instance.mesh)], instance);
        if (!(max_abs(world.lower) <= max_coordinate && max_abs(world.upper) <= max_coordinate))
            throw SceneError{expected_found(mesh_where(scene, scene.meshes[index(instance.mesh)]),
                                            "world coordinates of at most 1e18 metres", "larger ones")};
        scene.bounds.add(world.lower);
        scene.bounds.add(world.upper);
    }
    if (scene.bounds.empty()) throw SceneError{expected_found(scene.name, "a scene with triangles", "none")};
}

void check_lights(const SceneData& scene) {
    const auto check = [&](bool good, std::string_view kind, std::size_t i) {
        if (!good)
            throw SceneError{expected_found(fmt::format("{}: {} light {}", scene.name, kind, i),
                                            "a finite position and intensities of at least 0",
                                            "something else")};
    };
    const auto good = [](Vec3 v, Spectrum s) { return relumine::is_finite(v) && is_radiance(s); };
    for (std::size_t i = 0; i < scene.point_lights.size(); ++i)
        check(good(scene.point_lights[i].position, scene.point_lights[i].intensity), "point", i);
    for (std::size_t i = 0; i < scene.spot_lights.size(); ++i)
        check(good(scene.spot_lights[i].position, scene.spot_lights[i].intensity), "spot", i);
    for (std::size_t i = 0; i < scene.directional_lights.size(); ++i)
        check(good(scene.directional_lights[i].direction, scene.directional_lights[i].irradiance),
              "directional", i);
}

void check_environment(const SceneData& scene) {
    if (!scene.environment) return;
    const Environment& environment = *scene.environment;
    const bool sized =
        environment.width >= 2 && environment.height >= 1
        && environment.radiance.size()
               == static_cast<std::size_t>(environment.width) * static_cast<std::size_t>(environment.height);
    if (!sized)
        throw SceneError{expected_found(scene.name + ": environment",
                                        "at least 2 × 1 texels, and as many values",
                                        fmt::format("{} × {} with {} values", environment.width,
                                                    environment.height, environment.radiance.size()))};
    for (const Spectrum& texel : environment.radiance)
        if (!is_radiance(texel))
            throw SceneError{expected_found(scene.name + ": environment", "finite radiance of at least 0",
                                            "something else")};
}

void check_cameras(const SceneData& scene) {
    for (const Camera& camera : scene.cameras) {
        const double extent = camera.vertical_extent;
        const bool good = is_finite(camera.world_from_camera) && !is_singular(camera.world_from_camera)
                          && extent > 0 && (camera.orthographic ? std::isfinite(extent) : extent < 3.1415926)
                          && camera.aspect >= 0 && std::isfinite(camera.aspect);
        if (!good)
            throw SceneError{
                expected_found(fmt::format("{}: camera {}", scene.name, quote(camera.name)),
                               "a finite, invertible transform and a field of view between 0 and π",
                               fmt::format("field of view {:g}, aspect {:g}", extent, camera.aspect))};
    }
}

}  // namespace

bool emits_light(const SceneData& scene) {
    if (!scene.point_lights.empty() || !scene.spot_lights.empty() || !scene.directional_lights.empty())
        return true;
    if (scene.environment) return true;
    for (const Mesh& mesh : scene.meshes)
        if (!is_black(scene.materials[index(mesh.material)].emission)) return true;
    return false;
}

SceneData finish_scene(SceneData scene) {
    check_instances(scene);
    check_materials(scene);
    check_lights(scene);
    check_environment(scene);
    check_cameras(scene);
    drop_singular_instances(scene);
    bake_single_instances(scene);
    finish_meshes(scene);
    drop_unused_meshes(scene);
    compute_bounds(scene);
    if (!emits_light(scene)) scene.warn("nothing in this scene emits light; --environment FILE adds some");
    if (scene.cameras.empty()) scene.cameras.push_back(framing_camera(scene.bounds));
    return scene;
}

}  // namespace relumine
