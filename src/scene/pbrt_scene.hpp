// SPDX-License-Identifier: Apache-2.0
// What a pbrt file says, before anything is made of it: entities with their parameters and transforms.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/transform.hpp"
#include "scene/pbrt_parameters.hpp"

namespace relumine {

struct PbrtEntity {
    std::string type;
    PbrtParameters parameters;
};

/// The material of a shape: the one of that number, or that name, which may be defined later.
struct PbrtMaterialRef {
    std::size_t number = 0;
    std::string name;  // of MakeNamedMaterial; "" for those of Material
    PbrtPlace place;
};

struct PbrtShape {
    PbrtEntity entity;
    Transform world_from_object;
    bool reverse_orientation = false;
    PbrtMaterialRef material;
    std::optional<std::size_t> area_light;
};

struct PbrtTexture {
    PbrtEntity entity;
    Transform world_from_texture;
};

struct PbrtLight {
    PbrtEntity entity;
    Transform world_from_light;
};

struct PbrtInstance {
    std::string object;
    PbrtPlace place;
    Transform world_from_instance;
};

/// A parsed file with all that it includes. Coordinates are pbrt's world, whose numbers we keep as they are.
struct PbrtScene {
    std::optional<PbrtEntity> film, camera, integrator, sampler;
    Transform camera_from_world;
    std::vector<PbrtEntity> materials;  // 0: what shapes have that name none
    std::map<std::string, PbrtEntity> named_materials;
    std::map<std::string, PbrtTexture> float_textures, spectrum_textures;
    std::vector<PbrtEntity> area_lights;
    std::vector<PbrtLight> lights;
    std::vector<PbrtShape> shapes;
    std::map<std::string, std::vector<PbrtShape>> objects;
    std::vector<PbrtInstance> instances;
    std::vector<std::string> warnings;

    /// "file:line:column: text".
    void warn(const PbrtPlace& place, const std::string& text);
};

}  // namespace relumine
