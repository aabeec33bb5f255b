// SPDX-License-Identifier: Apache-2.0
// A scene: loaded from a file or built in memory, validated, immutable.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace relumine {

struct SceneData;

/// What `load_scene` may add to or replace in a file's scene.
struct SceneOptions {
    std::string environment;  // lat-long `.exr`, `.hdr` or `.pfm` that replaces the scene's own; "" keeps it
    float environment_scale = 1;                 // multiplies the environment's radiance, ≥ 0
    float environment_rotation_degrees = 0;      // counter-clockwise seen from +Y
    std::vector<std::string> allowed_folders{};  // where files that the scene names may lie, besides its own
    std::uint64_t texture_limit = 0;  // bytes of all textures, which are halved until they fit; 0: none
    std::map<std::string, std::string> definitions{};  // values of a Mitsuba scene's $parameters, by name
};

/// What a scene holds, for people and for tests.
struct SceneInfo {
    std::size_t meshes = 0, instances = 0;
    std::size_t triangles = 0;            // in memory: an instanced mesh counts once
    std::size_t instanced_triangles = 0;  // as seen by rays: an instanced mesh counts each time
    std::size_t materials = 0, textures = 0;
    std::size_t emissive_triangles = 0, point_lights = 0, spot_lights = 0, directional_lights = 0;
    bool has_environment = false;
    std::vector<std::string> cameras;                 // names, in file order; index = position
    std::array<float, 3> bounds_min{}, bounds_max{};  // world space, metres
    std::size_t memory_bytes = 0;                     // geometry and textures
    std::vector<std::string> warnings;                // each once: what is supported only in part, and where
};

/// An immutable scene. Copies are cheap: they share the data.
class Scene {
  public:
    explicit Scene(std::shared_ptr<const SceneData> data) : data_(std::move(data)) {}

    [[nodiscard]] SceneInfo info() const;
    [[nodiscard]] const SceneData& data() const {
        return *data_;
    }  // internal representation, not part of the API

  private:
    std::shared_ptr<const SceneData>
        data_;  // shared: scenes are values, their data is large and never changes
};

/// Loads `.gltf`/`.glb` and `.pbrt`; `.ply`/`.ply.gz`/`.obj` open as a model on a neutral ground under a
/// built-in sky. Throws SceneError or ImageError (where, expected, found), SettingsError for bad options.
[[nodiscard]] Scene load_scene(const std::string& path, const SceneOptions& options = {});

/// A column-major 4 × 4 affine matrix, as in glTF; maps object to world space (metres, Y up, right-handed).
using Matrix4 = std::array<double, 16>;
inline constexpr Matrix4 identity_matrix{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};

/// A glTF metallic-roughness surface without textures. Colours are linear Rec. 709, factors in [0, 1].
struct MaterialDescription {
    std::string name;
    std::array<float, 3> base_color{1, 1, 1};
    float metallic = 0;
    float roughness = 1;              // perceptual: GGX α = roughness²
    std::array<float, 3> emission{};  // radiance, W·sr⁻¹·m⁻², ≥ 0
    bool double_sided = false;        // whether the back emits too; both sides always reflect
    float ior = 1.5f;                 // ≥ 1
    float specular = 1;               // KHR_materials_specular
    float transmission = 0;           // KHR_materials_transmission
    bool solid = false;               // a closed body that refracts, instead of a thin sheet
};

/// Triangles as spans of the caller's memory, copied by `SceneBuilder::add_mesh`.
struct MeshDescription {
    std::string name;
    std::span<const std::array<float, 3>> positions;  // object space
    std::span<const std::array<float, 3>> normals;    // unit, per position; empty: flat shading
    std::span<const std::array<float, 2>> uvs;        // per position; may be empty
    std::span<const std::array<std::uint32_t, 3>> triangles;
    std::size_t material = 0;  // index returned by add_material
};

struct PointLightDescription {
    std::array<float, 3> position{};   // world space
    std::array<float, 3> intensity{};  // W·sr⁻¹
};

struct DirectionalLightDescription {
    std::array<float, 3> direction{0, -1, 0};  // the way the light travels, world space
    std::array<float, 3> irradiance{};         // W·m⁻² on a surface that faces it
};

struct CameraDescription {
    std::string name;
    Matrix4 world_from_camera = identity_matrix;  // looks along −Z, +Y up
    double vertical_fov = 0.7;                    // radians, perspective
    double orthographic_height = 0;               // metres; > 0 makes the camera orthographic
    double aspect = 1;                            // width / height
};

/// Builds a scene from memory. Everything is validated in `build()`, which throws SceneError.
class SceneBuilder {
  public:
    SceneBuilder();
    ~SceneBuilder();
    SceneBuilder(SceneBuilder&&) noexcept;
    SceneBuilder& operator=(SceneBuilder&&) noexcept;

    std::size_t add_material(const MaterialDescription& material);
    std::size_t add_mesh(const MeshDescription& mesh);
    void add_instance(std::size_t mesh, const Matrix4& world_from_object = identity_matrix);
    void add_light(const PointLightDescription& light);
    void add_light(const DirectionalLightDescription& light);
    void add_camera(const CameraDescription& camera);
    /// Lat-long radiance, row 0 up, `width × height` RGB triples.
    void set_environment(int width, int height, std::span<const float> rgb);

    /// The finished scene; the builder is empty afterwards.
    [[nodiscard]] Scene build();

  private:
    std::unique_ptr<SceneData> data_;
};

}  // namespace relumine
