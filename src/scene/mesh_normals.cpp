// SPDX-License-Identifier: Apache-2.0
// Normals of meshes that come without them.
#include "scene/mesh_normals.hpp"

#include <cmath>

namespace relumine {
namespace {

constexpr float cos_crease = 0.76604444f;  // cos 40°

/// The unit vector along `v`, safe for very large and very small ones; `fallback` for none.
Vec3 unit_or(Vec3 v, Vec3 fallback) {
    const float largest = max_abs(v);
    return largest > 0 && largest < infinity ? normalize(v / largest) : fallback;
}

/// Radians; 0 where the triangle is degenerate.
float corner_angle(const Mesh& mesh, const Triangle& triangle, std::size_t corner) {
    const Vec3 p = mesh.positions[triangle.vertex[corner]];
    const Vec3 u = unit_or(mesh.positions[triangle.vertex[(corner + 1) % 3]] - p, {});
    const Vec3 v = unit_or(mesh.positions[triangle.vertex[(corner + 2) % 3]] - p, {});
    return std::atan2(length(cross(u, v)), dot(u, v));
}

template <typename T>
void append_copy(std::vector<T>& attribute, std::size_t vertex) {
    if (!attribute.empty()) attribute.push_back(T{attribute[vertex]});
}

/// A new vertex like `vertex`, but with its own normal.
std::uint32_t split_off(Mesh& mesh, std::uint32_t vertex, Vec3 normal) {
    append_copy(mesh.positions, vertex);
    append_copy(mesh.tangents, vertex);
    append_copy(mesh.uvs[0], vertex);
    append_copy(mesh.uvs[1], vertex);
    append_copy(mesh.colors, vertex);
    mesh.normals.push_back(normal);
    return static_cast<std::uint32_t>(mesh.positions.size() - 1);
}

}  // namespace

Vec3 area_vector(const Mesh& mesh, const Triangle& triangle) {
    const auto [a, b, c] = triangle.vertex;
    return cross(mesh.positions[b] - mesh.positions[a], mesh.positions[c] - mesh.positions[a]);
}

std::vector<Vec3> mean_normals(const Mesh& mesh) {
    std::vector<Vec3> normals(mesh.positions.size());
    for (const Triangle& triangle : mesh.triangles) {
        const Vec3 flat = unit_or(area_vector(mesh, triangle), {});
        for (std::size_t corner = 0; corner < 3; ++corner)
            normals[triangle.vertex[corner]] += flat * corner_angle(mesh, triangle, corner);
    }
    for (Vec3& n : normals) n = unit_or(n, {0, 1, 0});
    return normals;
}

void add_creased_normals(Mesh& mesh) {
    mesh.normals = mean_normals(mesh);
    for (Triangle& triangle : mesh.triangles) {
        const Vec3 flat = unit_or(area_vector(mesh, triangle), {0, 1, 0});
        for (std::uint32_t& vertex : triangle.vertex)
            if (dot(flat, mesh.normals[vertex]) < cos_crease) vertex = split_off(mesh, vertex, flat);
    }
}

}  // namespace relumine
