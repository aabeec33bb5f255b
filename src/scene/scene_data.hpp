// SPDX-License-Identifier: Apache-2.0
// The scene as the renderer sees it: flat arrays, indices instead of pointers, immutable once finished.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/pixel_rect.hpp"
#include "base/transform.hpp"
#include "base/vec.hpp"
#include "image/byte_image.hpp"

namespace relumine {

enum class MeshId : std::uint32_t {};
enum class MaterialId : std::uint32_t {};
enum class ImageId : std::uint32_t {};
template <typename Id>
constexpr std::size_t index(Id id) {
    return static_cast<std::size_t>(id);
}

enum class Wrap : std::uint8_t { repeat, mirror, clamp };

/// How a material reads an image: which coordinates, how they are transformed and wrapped.
struct TextureRef {
    ImageId image{};
    int uv_set = 0;                                       // 0 or 1
    std::array<float, 6> uv_transform{1, 0, 0, 0, 1, 0};  // rows of 2 × 3: uv' = A·uv + b; v grows downwards
    Wrap wrap_u = Wrap::repeat, wrap_v = Wrap::repeat;
    bool nearest = false;  // no interpolation
    std::optional<ImageId>
        turned_away;  // what surfaces show that do not face TextureProjection::axis; blended with `image`
};

enum class AlphaMode : std::uint8_t { opaque, mask, blend };

/// glTF 2.0 metallic-roughness with KHR extensions; every factor multiplies its texture.
struct Material {
    std::string name;
    Spectrum base_color{1};  // linear; texture sRGB
    float base_alpha = 1;
    std::optional<TextureRef> base_color_texture;  // RGBA
    float metallic = 1, roughness = 1;
    std::optional<TextureRef> metallic_roughness_texture;  // B, G; linear
    // KHR_materials_anisotropy. Along the tangent, turned by the rotation towards the bitangent, α is
    // lerp(roughness², 1, anisotropy²); across it, it is roughness².
    float anisotropy = 0, anisotropy_rotation = 0;  // strength, radians
    std::optional<TextureRef> anisotropy_texture;   // RG: direction from −1 to 1, B: strength; linear
    std::optional<TextureRef> normal_texture;       // tangent space, linear
    float normal_scale = 1;
    Spectrum emission;                           // radiance, W·sr⁻¹·m⁻², emissive strength included
    std::optional<TextureRef> emission_texture;  // RGB, sRGB
    AlphaMode alpha_mode = AlphaMode::opaque;
    float alpha_cutoff = 0.5f;
    bool double_sided = false;                   // whether the back emits; both sides reflect
    float ior = 1.5f;                            // ≥ 1
    float specular = 1;                          // KHR_materials_specular; 0 removes the dielectric's coat
    std::optional<TextureRef> specular_texture;  // A
    Spectrum specular_color{1};
    std::optional<TextureRef> specular_color_texture;  // RGB, sRGB
    float transmission = 0;
    std::optional<TextureRef> transmission_texture;  // R
    bool solid = false;             // KHR_materials_volume with thickness > 0: refracts; else a thin sheet
    Spectrum attenuation_color{1};  // of light that went attenuation_distance through a solid
    float attenuation_distance = infinity;  // metres
    bool coated_diffuse = false;            // the model CoatedDiffuse: base = base_color / specular
    Spectrum diffuse_transmission;  // not black: the model DiffuseTransmission; base_color is reflected
    std::optional<TextureRef> diffuse_transmission_texture;                    // RGB, sRGB
    float clearcoat = 0, clearcoat_roughness = 0;                              // KHR_materials_clearcoat
    std::optional<TextureRef> clearcoat_texture, clearcoat_roughness_texture;  // R; G
    Spectrum sheen_color;                                                      // KHR_materials_sheen
    float sheen_roughness = 0;
    std::optional<TextureRef> sheen_color_texture, sheen_roughness_texture;  // RGB, sRGB; A
};

/// Whether the material's lobes have an orientation on the surface.
inline bool is_anisotropic(const Material& m) { return m.anisotropy > 0; }

struct Triangle {
    std::array<std::uint32_t, 3> vertex;
};

/// What textures are read by beside a mesh's own coordinates: where in the world a point lies and how it
/// faces, as pbrt's mappings have it. Per hit, since neither is linear over a triangle nor the same for all
/// instances.
struct TextureProjection {
    enum class Kind : std::uint8_t { none, planar, spherical, cylindrical };
    Kind kind = Kind::none;        // makes UV set 1
    Transform texture_from_world;  // planar: x and y are the coordinates; else they go around z
    Vec3 axis;                     // world space, unit; 0: no texture asks how a surface faces it
    bool smooth = false;           // that is, the vertices' normal, instead of the triangle's
};

/// Triangles of one material in object space (in world space where the mesh has one instance: see
/// finish_scene).
struct Mesh {
    std::string name;
    std::vector<Vec3> positions;
    std::vector<Vec3> normals;    // unit, per vertex; empty: flat shading
    std::vector<Vec4> tangents;   // xyz unit, w = handedness ±1, per vertex; may be empty
    bool facet_tangents = false;  // where empty: each triangle's own ∂p/∂u, as in pbrt and Mitsuba
    std::array<std::vector<Vec2>, 2> uvs;      // per vertex; may be empty; v grows downwards
    std::vector<std::array<float, 4>> colors;  // linear RGBA times base colour, per vertex; may be empty
    std::vector<Triangle> triangles;
    MaterialId material{};
    std::shared_ptr<const TextureProjection> projection = nullptr;  // null: none of its textures needs one
};

struct Instance {
    MeshId mesh{};
    Transform world_from_object;
    bool identity = false;  // set by finish_scene: the mesh is already in world space
};

/// How a light's intensity depends on the direction: a picture of factors, read without interpolation.
struct LightPattern {
    Transform light_from_world;  // its linear part
    bool equal_area = true;      // a square of all directions, else a perspective picture around +Z
    double half_width = 1,
           half_height = 1;  // of the perspective picture, at unit distance; +Y is its upper edge
    int width = 0, height = 0;
    std::vector<Spectrum> factor;  // row-major, top row first
};

struct PointLight {
    Vec3 position;
    Spectrum intensity;                                     // W·sr⁻¹
    std::shared_ptr<const LightPattern> pattern = nullptr;  // multiplies the intensity; null: even
};
struct SpotLight {
    Vec3 position;
    Vec3 direction;      // unit, the axis along which light leaves
    Spectrum intensity;  // W·sr⁻¹ on the axis
    float cos_inner = 1, cos_outer = 0.70710678f;
    bool smoothstep = false;  // between the angles: pbrt's smooth step instead of glTF's square
};
struct DirectionalLight {
    Vec3 direction;       // unit, the way the light travels
    Spectrum irradiance;  // W·m⁻² on a surface that faces it
};

/// Light from infinity: lat-long radiance, u = atan2(z, x)/2π + ½, v = acos(y)/π, row 0 up, bilinear between
/// texel centres.
struct Environment {
    int width = 0, height = 0;
    std::vector<Spectrum> radiance;  // row-major, ≥ 0, finite, scale included
    float rotation = 0;              // radians, counter-clockwise seen from +Y
};

/// Pictures of all directions, around the camera's Y axis.
enum class Panorama : std::uint8_t { none, lat_long, equal_area };

struct Camera {
    std::string name;
    Transform world_from_camera;  // looks along −Z, +Y up
    bool orthographic = false;
    double vertical_extent = 0.7;     // field of view in radians, or full height in metres if orthographic
    double aspect = 0;                // width / height; 0: as the picture's
    double stretch = 1;               // width over height of what a pixel sees
    double shift_x = 0, shift_y = 0;  // of the picture's middle, to the right and upwards, in half heights
    double lens_radius = 0, focus_distance = 0;  // thin lens: in units of the camera's space; 0: a pinhole
    Panorama panorama = Panorama::none;
    int width = 0, height = 0;      // pixels that the scene asks for; 0: nothing
    std::optional<PixelRect> crop;  // of that picture
};

/// Everything. Readers fill it, `finish_scene` validates it; nothing changes it afterwards.
struct SceneData {
    std::string name;  // file, for messages
    std::vector<Mesh> meshes;
    std::vector<Instance> instances;
    std::vector<Material> materials;
    std::vector<ByteImage> images;
    std::vector<PointLight> point_lights;
    std::vector<SpotLight> spot_lights;
    std::vector<DirectionalLight> directional_lights;
    std::optional<Environment> environment;
    std::vector<Camera> cameras;
    std::vector<std::string> warnings;  // each once
    Bounds3 bounds;                     // world space; set by finish_scene

    /// Notes what is supported only in part; the same text is kept once.
    void warn(std::string text);
};

}  // namespace relumine
