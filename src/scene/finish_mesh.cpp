// SPDX-License-Identifier: Apache-2.0
// Meshes made trustworthy.
#include "scene/finish_mesh.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/frame.hpp"
#include "base/message.hpp"
#include "relumine/error.hpp"
#include "scene/mesh_normals.hpp"
#include "scene/quote.hpp"
#include "scene/tangents.hpp"

namespace relumine {
namespace {

constexpr float max_coordinate = 1e18f;    // metres
constexpr std::size_t spare_vertices = 2;  // Embree reads 16 bytes where a vertex begins: 4 more than it has
constexpr std::uint32_t unused = 0xffffffffu;  // no new index

/// What was dropped or repaired in all meshes.
struct Repairs {
    std::size_t triangles = 0, normals = 0, uvs = 0;
};

template <typename T>
void check_size(const std::vector<T>& attribute, const Mesh& mesh, std::string_view what,
                const std::string& where) {
    if (attribute.empty() || attribute.size() == mesh.positions.size()) return;
    throw SceneError{expected_found(where, fmt::format("{} {}, one per vertex", mesh.positions.size(), what),
                                    fmt::format("{}", attribute.size()))};
}

void check_sizes(const Mesh& mesh, const SceneData& scene, const std::string& where) {
    if (mesh.positions.size() >= unused)
        throw SceneError{
            expected_found(where, "less than 2^32 − 1 vertices", fmt::format("{}", mesh.positions.size()))};
    if (index(mesh.material) >= scene.materials.size())
        throw SceneError{expected_found(where, fmt::format("a material below {}", scene.materials.size()),
                                        fmt::format("{}", index(mesh.material)))};
    check_size(mesh.normals, mesh, "normals", where);
    check_size(mesh.tangents, mesh, "tangents", where);
    check_size(mesh.uvs[0], mesh, "UVs", where);
    check_size(mesh.uvs[1], mesh, "UVs", where);
    check_size(mesh.colors, mesh, "colours", where);
}

/// Indices in range, and finite positions at all vertices that a triangle uses.
void check_triangles(const Mesh& mesh, const std::string& where) {
    const auto count = static_cast<std::uint32_t>(mesh.positions.size());
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        for (const std::uint32_t vertex : mesh.triangles[i].vertex) {
            if (vertex >= count)
                throw SceneError{expected_found(fmt::format("{}: triangle {}", where, i),
                                                fmt::format("vertices below {}", count),
                                                fmt::format("{}", vertex))};
            const Vec3 p = mesh.positions[vertex];
            if (!(max_abs(p) <= max_coordinate) || !is_finite(p))
                throw SceneError{expected_found(fmt::format("{}: vertex {}", where, vertex),
                                                "finite coordinates of at most 1e18",
                                                fmt::format("({:g}, {:g}, {:g})", p.x, p.y, p.z))};
        }
    }
}

/// Whether the triangle has no area, or one so small that floats cannot tell its normal.
bool is_degenerate(const Mesh& mesh, const Triangle& triangle) {
    const auto [a, b, c] = triangle.vertex;
    if (a == b || b == c || c == a) return true;
    const Vec3 p = mesh.positions[a], q = mesh.positions[b], r = mesh.positions[c];
    const double ux = double{q.x} - p.x, uy = double{q.y} - p.y, uz = double{q.z} - p.z;
    const double vx = double{r.x} - p.x, vy = double{r.y} - p.y, vz = double{r.z} - p.z;
    const double nx = uy * vz - uz * vy, ny = uz * vx - ux * vz, nz = ux * vy - uy * vx;
    return !(nx * nx + ny * ny + nz * nz > 1e-37);  // twice the area, squared
}

std::size_t drop_degenerate_triangles(Mesh& mesh) {
    return std::erase_if(mesh.triangles,
                         [&](const Triangle& triangle) { return is_degenerate(mesh, triangle); });
}

template <typename T>
void keep_used(std::vector<T>& attribute, const std::vector<std::uint32_t>& new_index) {
    if (attribute.empty()) return;
    for (std::size_t i = 0; i < new_index.size(); ++i)
        if (new_index[i] != unused)
            attribute[new_index[i]] = attribute[i];  // new indices never overtake old ones
    attribute.resize(static_cast<std::size_t>(
        std::ranges::count_if(new_index, [](std::uint32_t vertex) { return vertex != unused; })));
    attribute.shrink_to_fit();
}

/// Vertices that no triangle uses: glTF primitives often share one big vertex array.
void drop_unused_vertices(Mesh& mesh) {
    std::vector<std::uint32_t> new_index(mesh.positions.size(), unused);
    for (const Triangle& triangle : mesh.triangles)
        for (const std::uint32_t vertex : triangle.vertex) new_index[vertex] = 0;
    std::uint32_t next = 0;
    for (std::uint32_t& vertex : new_index)
        if (vertex != unused) vertex = next++;
    if (next == new_index.size()) return;
    for (Triangle& triangle : mesh.triangles)
        for (std::uint32_t& vertex : triangle.vertex) vertex = new_index[vertex];
    keep_used(mesh.positions, new_index);
    keep_used(mesh.normals, new_index);
    keep_used(mesh.tangents, new_index);
    keep_used(mesh.uvs[0], new_index);
    keep_used(mesh.uvs[1], new_index);
    keep_used(mesh.colors, new_index);
}

bool is_direction(Vec3 v) {
    const float l = length_squared(v);
    return l > 1e-30f && l < 1e30f;
}

/// Makes normals unit; replaces those that are no directions by the mean normal of the triangles around.
std::size_t repair_normals(Mesh& mesh) {
    std::size_t repaired = 0;
    std::vector<Vec3> means;
    for (std::size_t i = 0; i < mesh.normals.size(); ++i) {
        if (is_direction(mesh.normals[i])) {
            mesh.normals[i] = normalize(mesh.normals[i]);
            continue;
        }
        if (means.empty()) means = mean_normals(mesh);
        mesh.normals[i] = means[i];
        ++repaired;
    }
    return repaired;
}

std::size_t repair_uvs(std::vector<Vec2>& uvs) {
    std::size_t repaired = 0;
    for (Vec2& uv : uvs) {
        if (std::isfinite(uv.x) && std::isfinite(uv.y)) continue;
        uv = {};
        ++repaired;
    }
    return repaired;
}

/// glTF clamps vertex colours to [0, 1]; NaN becomes 0.
void repair_colors(Mesh& mesh) {
    for (auto& color : mesh.colors)
        for (float& channel : color) channel = channel > 0 ? std::min(channel, 1.0f) : 0.0f;
}

void repair_tangents(Mesh& mesh) {
    for (std::size_t i = 0; i < mesh.tangents.size(); ++i) {
        const Vec4 t = mesh.tangents[i];
        const Vec3 direction{t.x, t.y, t.z};
        const Vec3 normal = mesh.normals.empty() ? Vec3{0, 0, 1} : mesh.normals[i];
        const Vec3 unit = is_direction(direction) ? normalize(direction) : frame_around(normal).s;
        mesh.tangents[i] = {unit.x, unit.y, unit.z, t.w < 0 ? -1.0f : 1.0f};
    }
}

/// Where the material asks for tangents and the mesh has none: along u of its normal map, or else of what
/// orients its lobes.
void generate_tangents(Mesh& mesh, const Material& material) {
    const bool oriented = is_anisotropic(material) && !mesh.facet_tangents;
    if (!mesh.tangents.empty() || (!material.normal_texture && !oriented)) return;
    const auto& map = material.normal_texture ? material.normal_texture : material.anisotropy_texture;
    add_tangents(mesh, map ? static_cast<std::size_t>(map->uv_set) : 0);
}

void finish_mesh(Mesh& mesh, const SceneData& scene, Repairs& repairs) {
    const std::string where = fmt::format("{}: mesh {}", scene.name, quote(mesh.name));
    check_sizes(mesh, scene, where);
    check_triangles(mesh, where);
    repairs.triangles += drop_degenerate_triangles(mesh);
    drop_unused_vertices(mesh);
    repairs.normals += repair_normals(mesh);
    repairs.uvs += repair_uvs(mesh.uvs[0]) + repair_uvs(mesh.uvs[1]);
    repair_colors(mesh);
    generate_tangents(mesh, scene.materials[index(mesh.material)]);
    repair_tangents(mesh);
    mesh.positions.reserve(mesh.positions.size() + spare_vertices);
}

}  // namespace

void finish_meshes(SceneData& scene) {
    Repairs repairs;
    for (Mesh& mesh : scene.meshes) finish_mesh(mesh, scene, repairs);
    if (repairs.triangles > 0)
        scene.warn(fmt::format("{} triangles without area were left out", repairs.triangles));
    if (repairs.normals > 0)
        scene.warn(fmt::format("{} normals had no direction and were replaced by their triangles'",
                               repairs.normals));
    if (repairs.uvs > 0)
        scene.warn(fmt::format("{} texture coordinates were not finite and became 0", repairs.uvs));
}

void move_to_world(Mesh& mesh, const Transform& world_from_object) {
    if (world_from_object == Transform{}) return;
    const bool mirrored = determinant(world_from_object) < 0;
    const Transform world_from_object_normal = cofactor(world_from_object);
    for (Vec3& p : mesh.positions) p = world_from_object.point(p);
    for (Vec3& n : mesh.normals) {
        const Vec3 world = world_from_object_normal.vector(n);
        const Vec3 unit = normalize(world / max_abs(world));  // scaled first: cofactors are squares of scales
        n = mirrored ? -unit : unit;
    }
    for (Vec4& t : mesh.tangents) {
        const Vec3 world = world_from_object.vector({t.x, t.y, t.z});
        const Vec3 unit = normalize(world / max_abs(world));
        t = {unit.x, unit.y, unit.z, mirrored ? -t.w : t.w};
    }
    if (mirrored)  // a mirrored triangle would face inwards
        for (Triangle& triangle : mesh.triangles) std::swap(triangle.vertex[1], triangle.vertex[2]);
}

}  // namespace relumine
