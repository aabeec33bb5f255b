// SPDX-License-Identifier: Apache-2.0
// Loop subdivision surfaces: refined, moved to the limit, with the limit's normals [Loop87].
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "scene/pbrt_shapes.hpp"

namespace relumine {
namespace {

using Index = std::uint32_t;
constexpr int max_levels = 8;
constexpr std::size_t max_triangles = std::size_t{1} << 26;

/// Vertices around each vertex, in order. Of boundary vertices the first and the last lie on the boundary.
struct Ring {
    std::vector<Index> around;
    bool boundary = false;
};

/// The edges opposite to a vertex, as a walk: next[a] = b where (vertex, a, b) is a triangle.
Ring make_ring(const std::map<Index, Index>& next) {
    std::map<Index, int> entries;
    for (const auto& [from, to] : next) ++entries[to];
    Ring ring;
    Index start = next.begin()->first;
    for (const auto& [from, to] : next) {
        if (entries.contains(from)) continue;
        start = from;
        ring.boundary = true;
        break;
    }
    Index at = start;
    ring.around.push_back(at);
    while (ring.around.size() <= next.size()) {
        const auto it = next.find(at);
        if (it == next.end()) break;
        at = it->second;
        if (at == start) break;
        ring.around.push_back(at);
    }
    return ring;
}

std::vector<Ring> make_rings(const std::vector<Triangle>& triangles, std::size_t vertices) {
    std::vector<std::map<Index, Index>> next(vertices);
    for (const Triangle& t : triangles)
        for (std::size_t i = 0; i < 3; ++i) next[t.vertex[i]][t.vertex[(i + 1) % 3]] = t.vertex[(i + 2) % 3];
    std::vector<Ring> rings(vertices);
    for (std::size_t i = 0; i < vertices; ++i)
        if (!next[i].empty()) rings[i] = make_ring(next[i]);
    return rings;
}

/// Loop's weight of each neighbour, as pbrt chooses it.
float beta(std::size_t valence) {
    return valence == 3 ? 3.0f / 16 : 3.0f / (8 * static_cast<float>(valence));
}
float gamma(std::size_t valence) { return 1 / (static_cast<float>(valence) + 3 / (8 * beta(valence))); }

/// A weighted mean with the neighbours: `b` each inside, `edge` each of the two along a boundary.
Vec3 smoothed(const std::vector<Vec3>& p, std::size_t i, const Ring& ring, float b, float edge) {
    if (ring.around.empty()) return p[i];
    if (ring.boundary) return p[i] * (1 - 2 * edge) + (p[ring.around.front()] + p[ring.around.back()]) * edge;
    Vec3 sum = p[i] * (1 - static_cast<float>(ring.around.size()) * b);
    for (const Index neighbour : ring.around) sum += p[neighbour] * b;
    return sum;
}

using Edge = std::pair<Index, Index>;
Edge edge_of(Index a, Index b) { return {std::min(a, b), std::max(a, b)}; }

/// The corners opposite to an edge: two inside, one at a boundary.
struct Opposite {
    Index first = 0, second = 0;
    int count = 0;
};

void refine(std::vector<Vec3>& positions, std::vector<Triangle>& triangles) {
    std::map<Edge, Opposite> edges;
    for (const Triangle& t : triangles) {
        for (std::size_t i = 0; i < 3; ++i) {
            Opposite& opposite = edges[edge_of(t.vertex[i], t.vertex[(i + 1) % 3])];
            (opposite.count++ == 0 ? opposite.first : opposite.second) = t.vertex[(i + 2) % 3];
        }
    }
    const std::vector<Ring> rings = make_rings(triangles, positions.size());
    std::vector<Vec3> next;
    for (std::size_t i = 0; i < positions.size(); ++i)
        next.push_back(smoothed(positions, i, rings[i], beta(rings[i].around.size()), 1.0f / 8));
    std::map<Edge, Index> middles;
    for (const auto& [edge, opposite] : edges) {
        middles[edge] = static_cast<Index>(next.size());
        const Vec3 ends = positions[edge.first] + positions[edge.second];
        next.push_back(opposite.count == 1
                           ? ends * 0.5f
                           : ends * 0.375f
                                 + (positions[opposite.first] + positions[opposite.second]) * 0.125f);
    }
    std::vector<Triangle> finer;
    for (const Triangle& t : triangles) {
        const auto [a, b, c] = t.vertex;
        const Index ab = middles[edge_of(a, b)], bc = middles[edge_of(b, c)], ca = middles[edge_of(c, a)];
        finer.insert(finer.end(), {{{a, ab, ca}}, {{ab, b, bc}}, {{ca, bc, c}}, {{ab, bc, ca}}});
    }
    positions = std::move(next);
    triangles = std::move(finer);
}

/// Tangents across a boundary vertex, into the surface.
Vec3 boundary_tangent(const std::vector<Vec3>& p, std::size_t i, const Ring& ring) {
    const auto& r = ring.around;
    const std::size_t valence = r.size();
    if (valence == 2) return p[r[0]] + p[r[1]] - p[i] * 2.0f;
    if (valence == 3) return p[r[1]] - p[i];
    if (valence == 4)
        return p[r[0]] * -1.0f + p[r[1]] * 2.0f + p[r[2]] * 2.0f + p[r[3]] * -1.0f + p[i] * -2.0f;
    const float theta = pi / static_cast<float>(valence - 1);
    Vec3 t = (p[r.front()] + p[r.back()]) * std::sin(theta);
    for (std::size_t k = 1; k + 1 < valence; ++k)
        t += p[r[k]] * ((2 * std::cos(theta) - 2) * std::sin(static_cast<float>(k) * theta));
    return -t;
}

/// On the side from which triangles are clockwise: pbrt's outside of these surfaces.
Vec3 limit_normal(const std::vector<Vec3>& p, std::size_t i, const Ring& ring) {
    if (ring.around.size() < 2) return {};
    Vec3 s, t;
    if (ring.boundary) {
        s = p[ring.around.back()] - p[ring.around.front()];
        t = boundary_tangent(p, i, ring);
        return cross(s, t);
    }
    for (std::size_t k = 0; k < ring.around.size(); ++k) {
        const float angle = 2 * pi * static_cast<float>(k) / static_cast<float>(ring.around.size());
        s += p[ring.around[k]] * std::cos(angle);
        t += p[ring.around[k]] * std::sin(angle);
    }
    return cross(t, s);
}

}  // namespace

Mesh pbrt_loop_subdivision(const PbrtParameters& p) {
    const int levels = p.integer("levels", 3);
    (void)p.string("scheme", "loop");
    if (levels < 0 || levels > max_levels)
        p.refuse("levels", fmt::format("0 to {} levels", max_levels), fmt::format("{}", levels));
    Mesh mesh;
    mesh.positions = p.vectors("point3", "P");
    if (mesh.positions.empty()) p.refuse("P", "\"point3 P\"", "none");
    const std::vector<Index> corners = pbrt_indices(p, 3, mesh.positions.size());
    for (std::size_t i = 0; i + 2 < corners.size(); i += 3)
        mesh.triangles.push_back({{corners[i], corners[i + 1], corners[i + 2]}});
    if (mesh.triangles.size() > max_triangles >> (2 * levels))
        p.refuse("levels", fmt::format("at most {} triangles in all", max_triangles), "more");
    for (int level = 0; level < levels; ++level) refine(mesh.positions, mesh.triangles);
    const std::vector<Ring> rings = make_rings(mesh.triangles, mesh.positions.size());
    std::vector<Vec3> limit;
    for (std::size_t i = 0; i < mesh.positions.size(); ++i)
        limit.push_back(smoothed(mesh.positions, i, rings[i], gamma(rings[i].around.size()), 1.0f / 5));
    mesh.positions = std::move(limit);
    for (std::size_t i = 0; i < mesh.positions.size(); ++i)
        mesh.normals.push_back(limit_normal(mesh.positions, i, rings[i]));
    for (std::size_t i = 0; i < mesh.normals.size(); ++i) {
        const float l = max_abs(mesh.normals[i]);
        mesh.normals[i] = l > 0 ? normalize(mesh.normals[i] / l) : Vec3{};
    }
    return mesh;
}

}  // namespace relumine
