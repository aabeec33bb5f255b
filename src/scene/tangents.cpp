// SPDX-License-Identifier: Apache-2.0
// Tangents for normal maps of meshes that come without them.
#include "scene/tangents.hpp"

#include <cmath>

#include "base/frame.hpp"
#include "scene/mesh_normals.hpp"

namespace relumine {
namespace {

/// Directions in which u and v grow on the triangle, times its area; zero where the UVs have no area.
struct UvDirections {
    Vec3 du, dv;
};

UvDirections uv_directions(const Mesh& mesh, const std::vector<Vec2>& uvs, const Triangle& triangle) {
    const auto [a, b, c] = triangle.vertex;
    const Vec3 e1 = mesh.positions[b] - mesh.positions[a], e2 = mesh.positions[c] - mesh.positions[a];
    const Vec2 d1 = uvs[b] - uvs[a], d2 = uvs[c] - uvs[a];
    const float uv_area = d1.x * d2.y - d2.x * d1.y;
    if (uv_area == 0 || !std::isfinite(uv_area)) return {};
    const Vec3 du = (e1 * d2.y - e2 * d1.y) * std::copysign(1.0f, uv_area);
    const Vec3 dv = (e2 * d1.x - e1 * d2.x) * std::copysign(1.0f, uv_area);
    const float area = length(area_vector(mesh, triangle));
    const float lu = length(du), lv = length(dv);
    return {lu > 0 ? du * (area / lu) : Vec3{}, lv > 0 ? dv * (area / lv) : Vec3{}};
}

/// Orthogonal to the normal. The bitangent cross(n, t)·w points where v shrinks: normal maps have +Y upwards.
Vec4 tangent_at(Vec3 normal, const UvDirections& sum) {
    Vec3 t = sum.du - normal * dot(normal, sum.du);
    const float l = length(t);
    t = l > 0 && std::isfinite(l) ? t / l : frame_around(normal).s;
    return {t.x, t.y, t.z, dot(cross(normal, t), sum.dv) > 0 ? -1.0f : 1.0f};
}

}  // namespace

void add_tangents(Mesh& mesh, std::size_t uv_set) {
    const auto& uvs = mesh.uvs[uv_set];
    if (uvs.empty()) return;
    std::vector<UvDirections> sums(mesh.positions.size());
    for (const Triangle& triangle : mesh.triangles) {
        const UvDirections d = uv_directions(mesh, uvs, triangle);
        for (const std::uint32_t vertex : triangle.vertex) {
            sums[vertex].du += d.du;
            sums[vertex].dv += d.dv;
        }
    }
    const auto& normals = mesh.normals.empty() ? mean_normals(mesh) : mesh.normals;
    mesh.tangents.reserve(mesh.positions.size());
    for (std::size_t i = 0; i < mesh.positions.size(); ++i)
        mesh.tangents.push_back(tangent_at(normals[i], sums[i]));
}

}  // namespace relumine
