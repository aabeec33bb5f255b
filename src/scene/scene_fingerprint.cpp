// SPDX-License-Identifier: Apache-2.0
// Hashing scenes. Each structure is taken apart by name, so that a member added to it does not compile here
// until it is hashed too.
#include "scene/scene_fingerprint.hpp"

#include "base/fingerprint.hpp"

namespace relumine {
namespace {

// Hashed as raw bytes: nothing but their members, no padding.
static_assert(sizeof(Vec2) == 2 * sizeof(float) && sizeof(Vec3) == 3 * sizeof(float)
              && sizeof(Vec4) == 4 * sizeof(float) && sizeof(Spectrum) == 3 * sizeof(float)
              && sizeof(Triangle) == 3 * sizeof(std::uint32_t) && sizeof(Transform) == 12 * sizeof(double));

void add(Fingerprint& print, Vec3 v) {
    for (const float x : {v.x, v.y, v.z}) print.add(x);
}
void add(Fingerprint& print, Spectrum s) {
    for (const float x : {s.r, s.g, s.b}) print.add(x);
}
void add(Fingerprint& print, const Transform& t) {
    for (const auto& row : t.m)
        for (const double x : row) print.add(x);
}
template <typename... Values>
void add_each(Fingerprint& print, Values... values) {
    (print.add(values), ...);
}

void add(Fingerprint& print, const std::optional<TextureRef>& texture) {
    print.add(texture.has_value());
    if (!texture) return;
    const auto& [image, uv_set, uv_transform, wrap_u, wrap_v, nearest, turned_away] = *texture;
    for (const float x : uv_transform) print.add(x);
    add_each(print, image, uv_set, wrap_u, wrap_v, nearest, turned_away.has_value());
    if (turned_away) print.add(*turned_away);
}

void add(Fingerprint& print, const Material& material) {
    const auto& [name, base_color, base_alpha, base_color_texture, metallic, roughness,
                 metallic_roughness_texture, anisotropy, anisotropy_rotation, anisotropy_texture,
                 normal_texture, normal_scale, emission, emission_texture, alpha_mode, alpha_cutoff,
                 double_sided, ior, specular, specular_texture, specular_color, specular_color_texture,
                 transmission, transmission_texture, solid, attenuation_color, attenuation_distance,
                 coated_diffuse, diffuse_transmission, diffuse_transmission_texture, clearcoat,
                 clearcoat_roughness, clearcoat_texture, clearcoat_roughness_texture, sheen_color,
                 sheen_roughness, sheen_color_texture, sheen_roughness_texture] = material;
    (void)name;
    for (const Spectrum& colour :
         {base_color, emission, specular_color, attenuation_color, diffuse_transmission, sheen_color})
        add(print, colour);
    add_each(print, base_alpha, metallic, roughness, normal_scale, alpha_mode, alpha_cutoff, double_sided,
             ior, specular, transmission, solid, attenuation_distance, coated_diffuse, clearcoat,
             clearcoat_roughness, sheen_roughness, anisotropy, anisotropy_rotation);
    for (const auto* texture :
         {&base_color_texture, &metallic_roughness_texture, &normal_texture, &emission_texture,
          &specular_texture, &specular_color_texture, &transmission_texture, &diffuse_transmission_texture,
          &clearcoat_texture, &clearcoat_roughness_texture, &sheen_color_texture, &sheen_roughness_texture,
          &anisotropy_texture})
        add(print, *texture);
}

void add(Fingerprint& print, const TextureProjection& projection) {
    const auto& [kind, texture_from_world, axis, smooth] = projection;
    add(print, texture_from_world);
    add(print, axis);
    add_each(print, kind, smooth);
}

void add(Fingerprint& print, const Mesh& mesh) {
    const auto& [name, positions, normals, tangents, facet_tangents, uvs, colors, triangles, material,
                 projection] = mesh;
    (void)name;
    print.add_all(positions);
    print.add_all(normals);
    print.add_all(tangents);
    for (const auto& coordinates : uvs) print.add_all(coordinates);
    print.add_all(colors);
    print.add_all(triangles);
    add_each(print, facet_tangents, material, projection != nullptr);
    if (projection) add(print, *projection);
}

void add(Fingerprint& print, const Instance& instance) {
    const auto& [mesh, world_from_object, identity] = instance;
    add_each(print, mesh, identity);
    add(print, world_from_object);
}

void add(Fingerprint& print, const ByteImage& image) {
    const auto& [width, height, rgba8, rgba16] = image;
    add_each(print, width, height);
    print.add_all(rgba8);
    print.add_all(rgba16);
}

void add(Fingerprint& print, const LightPattern& pattern) {
    const auto& [light_from_world, equal_area, half_width, half_height, width, height, factor] = pattern;
    add(print, light_from_world);
    add_each(print, equal_area, half_width, half_height, width, height);
    print.add_all(factor);
}

void add(Fingerprint& print, const PointLight& light) {
    const auto& [position, intensity, pattern] = light;
    add(print, position);
    add(print, intensity);
    print.add(pattern != nullptr);
    if (pattern) add(print, *pattern);
}
void add(Fingerprint& print, const SpotLight& light) {
    const auto& [position, direction, intensity, cos_inner, cos_outer, smoothstep] = light;
    add(print, position);
    add(print, direction);
    add(print, intensity);
    add_each(print, cos_inner, cos_outer, smoothstep);
}
void add(Fingerprint& print, const DirectionalLight& light) {
    const auto& [direction, irradiance] = light;
    add(print, direction);
    add(print, irradiance);
}

void add(Fingerprint& print, const Environment& environment) {
    const auto& [width, height, radiance, rotation] = environment;
    add_each(print, width, height, rotation);
    print.add_all(radiance);
}

void add(Fingerprint& print, const Camera& camera) {
    const auto& [name, world_from_camera, orthographic, vertical_extent, aspect, stretch, shift_x, shift_y,
                 lens_radius, focus_distance, panorama, width, height, crop] = camera;
    print.add(std::string_view(name));
    add(print, world_from_camera);
    add_each(print, orthographic, vertical_extent, aspect, stretch, shift_x, shift_y, lens_radius,
             focus_distance, panorama, width, height, crop.has_value());
    if (crop) add_each(print, crop->x0, crop->y0, crop->x1, crop->y1);
}

/// Of all elements, in order.
template <typename... Lists>
std::uint64_t hash_of(const Lists&... lists) {
    Fingerprint print;
    const auto add_list = [&](const auto& list) {
        print.add(std::uint64_t{list.size()});
        for (const auto& element : list) add(print, element);
    };
    (add_list(lists), ...);
    return print.value();
}

}  // namespace

std::vector<std::pair<std::string, std::uint64_t>> scene_fingerprint(const SceneData& scene) {
    const auto& [name, meshes, instances, materials, images, point_lights, spot_lights, directional_lights,
                 environment, cameras, warnings, bounds] = scene;
    (void)name;
    (void)warnings;
    (void)bounds;  // of the geometry
    Fingerprint sky;
    sky.add(environment.has_value());
    if (environment) add(sky, *environment);
    return {{"geometry", hash_of(meshes)},
            {"instances", hash_of(instances)},
            {"materials", hash_of(materials)},
            {"textures", hash_of(images)},
            {"lights", hash_of(point_lights, spot_lights, directional_lights)},
            {"environment", sky.value()},
            {"cameras", hash_of(cameras)}};
}

}  // namespace relumine
