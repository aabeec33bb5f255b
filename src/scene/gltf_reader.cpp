// SPDX-License-Identifier: Apache-2.0
// Reads glTF 2.0, `.gltf` and `.glb`: ties the parts in gltf_*.cpp together.
#include <map>
#include <utility>

#include "scene/gltf_instancing.hpp"
#include "scene/gltf_lights.hpp"
#include "scene/gltf_material.hpp"
#include "scene/gltf_mesh.hpp"
#include "scene/gltf_nodes.hpp"
#include "scene/readers.hpp"

namespace relumine {
namespace {

using MeshIds = std::vector<MeshId>;

/// Reads each mesh when a node first uses it.
class MeshTable {
  public:
    MeshTable(const GltfFile& file, SceneData& scene) : file_(file), scene_(scene) {}

    const MeshIds& ids(int mesh) {
        const auto [it, inserted] = ids_.try_emplace(mesh);
        if (inserted) {
            for (Mesh& part : read_gltf_mesh(file_, mesh, budget_, scene_)) {
                it->second.push_back(static_cast<MeshId>(scene_.meshes.size()));
                scene_.meshes.push_back(std::move(part));
            }
        }
        return it->second;
    }

  private:
    const GltfFile& file_;
    SceneData& scene_;
    GltfBudget budget_;
    std::map<int, MeshIds> ids_;
};

void add_instances(const GltfFile& file, const PlacedNode& placed, MeshTable& meshes, std::size_t& places,
                   SceneData& scene) {
    const int mesh = file.model.nodes[to_size(placed.node)].mesh;
    if (mesh < 0) return;
    const MeshIds& ids = meshes.ids(mesh);
    const auto many = read_gltf_instancing(file, placed.node, ids.size(), places);
    for (const MeshId id : ids) {
        if (!many) scene.instances.push_back({id, placed.world_from_node, false});
        for (const Transform& node_from_place : many.value_or(std::vector<Transform>{}))
            scene.instances.push_back({id, placed.world_from_node * node_from_place, false});
    }
}

/// glTF's material for primitives that name none: fully metallic, as the specification has it.
void add_default_material(SceneData& scene) {
    const auto missing = static_cast<MaterialId>(scene.materials.size());
    for (const Mesh& mesh : scene.meshes) {
        if (mesh.material != missing) continue;
        Material material;
        material.name = "default";
        scene.materials.push_back(std::move(material));
        return;
    }
}

}  // namespace

SceneData read_gltf(const std::string& path) {
    GltfFile file = read_gltf_file(path);
    SceneData scene;
    scene.name = path;
    for (std::string& warning : file.warnings) scene.warn(std::move(warning));
    MeshTable meshes{file, scene};
    std::size_t places = max_gltf_places;
    for (const PlacedNode& placed : place_nodes(file)) {
        add_instances(file, placed, meshes, places, scene);
        add_gltf_light(file, placed, scene);
        add_gltf_camera(file, placed, scene);
    }
    read_gltf_materials(file, scene);
    add_default_material(scene);
    return scene;
}

}  // namespace relumine
