// SPDX-License-Identifier: Apache-2.0
// From a hit to a surface point: interpolation, sides, normal maps.
#include "shading/surface_point.hpp"

#include "shading/texture.hpp"

namespace relumine {
namespace {

template <typename T>
T interpolate(const std::vector<T>& values, const Triangle& triangle, const Hit& hit) {
    const auto& [a, b, c] = triangle.vertex;
    return values[a] * (1 - hit.u - hit.v) + values[b] * hit.u + values[c] * hit.v;
}

Vec3 barycentric(const std::array<Vec3, 3>& corners, const Hit& hit) {
    return corners[0] * (1 - hit.u - hit.v) + corners[1] * hit.u + corners[2] * hit.v;
}

Vec3 xyz(Vec4 v) { return {v.x, v.y, v.z}; }

/// Object-space normals and tangents to world space (up to length). Copies nothing where the mesh is in world
/// space already.
class NormalMapper {
  public:
    explicit NormalMapper(const Instance& instance) : instance_(instance) {}

    [[nodiscard]] Vec3 normal(Vec3 n) const {
        return instance_.identity ? n : cofactor(instance_.world_from_object).vector(n) * winding();
    }
    [[nodiscard]] Vec3 tangent(Vec3 t) const {
        return instance_.identity ? t : instance_.world_from_object.vector(t);
    }
    /// The sign of a normal from transformed corners against the one of the mesh's own winding.
    [[nodiscard]] float winding() const {
        return instance_.identity || determinant(instance_.world_from_object) > 0 ? 1.0f : -1.0f;
    }

  private:
    const Instance& instance_;
};

/// Of a point of the projection's space; t grows upwards.
Vec2 projected_uv(const TextureProjection& projection, Vec3 world) {
    const Vec3 p = projection.texture_from_world.point(world);
    const float around = std::atan2(p.y, p.x) / (2 * pi);
    switch (projection.kind) {
        case TextureProjection::Kind::planar:
            return {p.x, p.y};
        case TextureProjection::Kind::cylindrical:
            return {0.5f + around, p.z};
        case TextureProjection::Kind::spherical: {
            const float off_axis = std::sqrt(sqr(p.x) + sqr(p.y));
            return {std::atan2(off_axis, p.z) / pi, around < 0 ? around + 1 : around};
        }
        case TextureProjection::Kind::none:
            break;
    }
    return {};
}

/// Not inlined: most meshes have none.
[[gnu::noinline]] void project(const SceneData& scene, const Mesh& mesh, const Hit& hit, TextureUv& uv) {
    const TextureProjection& projection = *mesh.projection;
    const std::array<Vec3, 3> corners = world_triangle(scene, hit.instance, hit.triangle);
    if (projection.kind != TextureProjection::Kind::none) {
        const Vec2 st = projected_uv(projection, barycentric(corners, hit));
        uv.sets[1] = {st.x, 1 - st.y};
    }
    if (length_squared(projection.axis) == 0) return;
    Vec3 normal = cross(corners[1] - corners[0], corners[2] - corners[0]);
    if (projection.smooth && !mesh.normals.empty())
        normal = NormalMapper(scene.instances[hit.instance])
                     .normal(interpolate(mesh.normals, mesh.triangles[hit.triangle], hit));
    if (length_squared(normal) > 0)
        uv.facing = std::min(std::abs(dot(normalize(normal), projection.axis)), 1.0f);
}

TextureUv texture_uv(const SceneData& scene, const Mesh& mesh, const Hit& hit) {
    TextureUv uv;
    for (std::size_t set = 0; set < uv.sets.size(); ++set)
        if (!mesh.uvs[set].empty())
            uv.sets[set] = interpolate(mesh.uvs[set], mesh.triangles[hit.triangle], hit);
    if (mesh.projection) project(scene, mesh, hit, uv);
    return uv;
}

/// The vertices' tangents at the hit, in world space, of any length; w is the handedness.
Vec4 world_tangent(const Mesh& mesh, const Triangle& triangle, const Hit& hit, const NormalMapper& map) {
    const auto& [a, b, c] = triangle.vertex;
    const Vec3 along = xyz(mesh.tangents[a]) * (1 - hit.u - hit.v) + xyz(mesh.tangents[b]) * hit.u
                       + xyz(mesh.tangents[c]) * hit.v;
    const Vec3 world = map.tangent(along);
    return {world.x, world.y, world.z, mesh.tangents[a].w * map.winding()};
}

/// ∂p/∂u of the triangle, in object space, of any length; 0 where it has no texture coordinates.
Vec3 facet_tangent(const Mesh& mesh, const Triangle& triangle) {
    const auto& [a, b, c] = triangle.vertex;
    const Vec3 e1 = mesh.positions[b] - mesh.positions[a], e2 = mesh.positions[c] - mesh.positions[a];
    if (mesh.uvs[0].empty()) return {};
    const Vec2 d1 = mesh.uvs[0][b] - mesh.uvs[0][a], d2 = mesh.uvs[0][c] - mesh.uvs[0][a];
    return (e1 * d2.y - e2 * d1.y) * std::copysign(1.0f, d1.x * d2.y - d2.x * d1.y);
}

/// The direction of increased roughness in tangent space, unit [KHR_materials_anisotropy].
Vec2 rougher_direction(const SceneData& scene, const Material& material, const TextureUv& uv) {
    const float c = std::cos(material.anisotropy_rotation), s = std::sin(material.anisotropy_rotation);
    if (!material.anisotropy_texture) return {c, s};
    const Vec4 texel = sample_texture(scene, *material.anisotropy_texture, uv, Encoding::linear);
    const float x = 2 * texel.x - 1, y = 2 * texel.y - 1, length = std::sqrt(sqr(x) + sqr(y));
    return length > 0 ? Vec2{(c * x - s * y) / length, (s * x + c * y) / length} : Vec2{c, s};
}

/// Along which the lobes of an anisotropic material are rougher, in world space, before any normal map. Not
/// inlined: isotropic surfaces have nothing to do with it.
[[gnu::noinline]] Vec3 lobe_axis(const SceneData& scene, const Mesh& mesh, const Hit& hit,
                                 const NormalMapper& map, const ShadingTriangle& at) {
    const Triangle& triangle = mesh.triangles[hit.triangle];
    const auto of_facet = [&] {
        const Vec3 t = map.tangent(facet_tangent(mesh, triangle));
        return Vec4{t.x, t.y, t.z, 1};
    };
    const Vec4 tangent = mesh.tangents.empty() ? of_facet() : world_tangent(mesh, triangle, hit, map);
    const Vec3 along = xyz(tangent);
    const auto& [a, b, c] = at.corners;
    const Vec3 normal =
        length_squared(at.normal) > 0 ? at.normal : cross(b - a, c - a) * map.winding();  // any length
    const Frame frame = frame_along(normalize(normal), along / std::max(max_abs(along), 1e-30f));
    const Vec2 rougher =
        rougher_direction(scene, scene.materials[index(mesh.material)], texture_uv(scene, mesh, hit));
    return frame.s * rougher.x + frame.t * (rougher.y * tangent.w);
}

/// The normal that a normal map asks for, unnormalised [glTF 2.0, §3.9.3].
Vec3 mapped_normal(const SceneData& scene, const SurfacePoint& p, Vec3 normal, Vec4 tangent) {
    const Vec4 texel = sample_texture(scene, *p.material->normal_texture, p.uv, Encoding::linear);
    const float scale = p.material->normal_scale;
    const Vec3 m{(2 * texel.x - 1) * scale, (2 * texel.y - 1) * scale, 2 * texel.z - 1};
    const Vec3 t = xyz(tangent) - normal * dot(normal, xyz(tangent));
    if (length_squared(t) == 0) return normal;
    const Vec3 unit_t = normalize(t);
    const Vec3 b = cross(normal, unit_t) * tangent.w;
    return unit_t * m.x + b * m.y + normal * m.z;
}

/// `n`, turned just enough that `w_out` is above it.
Vec3 keep_viewer_above(Vec3 n, Vec3 w_out) {
    const float cosine = dot(n, w_out);
    return cosine >= min_view_cosine ? n : normalize(n + w_out * (min_view_cosine - cosine));
}

Vec3 shading_normal(const SceneData& scene, const Mesh& mesh, const Triangle& triangle, const Hit& hit,
                    const NormalMapper& map, const SurfacePoint& p, Vec3 front_normal) {
    Vec3 n = front_normal;
    if (!mesh.normals.empty()) {
        const Vec3 smooth = map.normal(interpolate(mesh.normals, triangle, hit));
        if (length_squared(smooth) > 0) n = normalize(smooth);
    }
    if (p.material->normal_texture && !mesh.tangents.empty()) {
        const Vec3 mapped = mapped_normal(scene, p, n, world_tangent(mesh, triangle, hit, map));
        if (length_squared(mapped) > 0) n = normalize(mapped);
    }
    return n;
}

}  // namespace

std::array<Vec3, 3> world_triangle(const SceneData& scene, std::uint32_t instance_index,
                                   std::uint32_t triangle_index) {
    const Instance& instance = scene.instances[instance_index];
    const Mesh& mesh = scene.meshes[index(instance.mesh)];
    const auto& [a, b, c] = mesh.triangles[triangle_index].vertex;
    std::array<Vec3, 3> corners{mesh.positions[a], mesh.positions[b], mesh.positions[c]};
    if (!instance.identity)
        for (Vec3& corner : corners) corner = instance.world_from_object.point(corner);
    return corners;
}

ShadingTriangle shading_triangle(const SceneData& scene, const Hit& hit) {
    const Instance& instance = scene.instances[hit.instance];
    const Mesh& mesh = scene.meshes[index(instance.mesh)];
    const NormalMapper map(instance);
    ShadingTriangle triangle{world_triangle(scene, hit.instance, hit.triangle), {}, {}, map.winding()};
    if (!mesh.normals.empty())
        triangle.normal = map.normal(interpolate(mesh.normals, mesh.triangles[hit.triangle], hit));
    if (is_anisotropic(scene.materials[index(mesh.material)]))
        triangle.lobe_axis = lobe_axis(scene, mesh, hit, map, triangle);
    return triangle;
}

float rounding_offset(const std::array<Vec3, 3>& corners) {
    return rounding_units * std::max({max_abs(corners[0]), max_abs(corners[1]), max_abs(corners[2])});
}

TextureCoordinates texture_coordinates(const SceneData& scene, const Hit& hit) {
    const Mesh& mesh = scene.meshes[index(scene.instances[hit.instance].mesh)];
    const Triangle& triangle = mesh.triangles[hit.triangle];
    TextureCoordinates coordinates{texture_uv(scene, mesh, hit)};
    if (!mesh.colors.empty()) {
        const auto& [a, b, c] = triangle.vertex;
        coordinates.vertex_alpha =
            mesh.colors[a][3] * (1 - hit.u - hit.v) + mesh.colors[b][3] * hit.u + mesh.colors[c][3] * hit.v;
    }
    return coordinates;
}

SurfacePoint surface_point(const SceneData& scene, const Hit& hit, WorldDir w_out) {
    const Instance& instance = scene.instances[hit.instance];
    const Mesh& mesh = scene.meshes[index(instance.mesh)];
    const Triangle& triangle = mesh.triangles[hit.triangle];
    const std::array<Vec3, 3> corners = world_triangle(scene, hit.instance, hit.triangle);
    const NormalMapper map(instance);

    SurfacePoint p;
    p.position = barycentric(corners, hit);
    p.material = &scene.materials[index(mesh.material)];
    p.instance = hit.instance;
    p.triangle = hit.triangle;
    p.offset = rounding_offset(corners);
    p.uv = texture_uv(scene, mesh, hit);
    p.has_vertex_color = !mesh.colors.empty();
    if (p.has_vertex_color) {
        const auto color = [&](std::size_t i) {
            const auto& c = mesh.colors[triangle.vertex[i]];
            return Spectrum{c[0], c[1], c[2]};
        };
        p.vertex_color = color(0) * (1 - hit.u - hit.v) + color(1) * hit.u + color(2) * hit.v;
    }
    const Vec3 front_normal =
        normalize(cross(corners[1] - corners[0], corners[2] - corners[0])) * map.winding();
    p.front = dot(front_normal, w_out.v) >= 0;
    p.geometric_normal = p.front ? front_normal : -front_normal;
    Vec3 n = shading_normal(scene, mesh, triangle, hit, map, p, front_normal);
    n = face_forward(p.front ? n : -n, p.geometric_normal);
    n = keep_viewer_above(n, w_out.v);
    p.frame = is_anisotropic(*p.material) ? frame_along(n, shading_triangle(scene, hit).lobe_axis)
                                          : frame_around(n);
    return p;
}

}  // namespace relumine
