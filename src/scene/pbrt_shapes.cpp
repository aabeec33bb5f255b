// SPDX-License-Identifier: Apache-2.0
// pbrt's shapes as triangle meshes: triangle meshes, PLY files, sides and texture coordinates.
#include "scene/pbrt_shapes.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/message.hpp"
#include "relumine/error.hpp"
#include "scene/quote.hpp"
#include "scene/readers.hpp"

namespace relumine {
namespace {

std::vector<Vec2> flipped(std::vector<Vec2> uvs) {
    for (Vec2& uv : uvs) uv.y = 1 - uv.y;
    return uvs;
}

template <typename T>
void drop_other_sizes(std::vector<T>& attribute, std::size_t wanted, std::string_view name,
                      const PbrtParameters& p, PbrtScene& scene) {
    if (attribute.empty() || attribute.size() == wanted) return;
    scene.warn(p.place(), fmt::format("{} {} for {} vertices: they are not used", attribute.size(),
                                      quote(name), wanted));
    attribute.clear();
}

Mesh triangle_mesh(const PbrtParameters& p, PbrtScene& scene) {
    Mesh mesh;
    mesh.positions = p.vectors("point3", "P");
    if (mesh.positions.empty()) p.refuse("P", "\"point3 P\"", "none");
    mesh.normals = p.vectors("normal", "N");
    mesh.uvs[0] = flipped(p.points2("uv"));
    p.ignore({"S", "faceIndices"});
    drop_other_sizes(mesh.normals, mesh.positions.size(), "N", p, scene);
    drop_other_sizes(mesh.uvs[0], mesh.positions.size(), "uv", p, scene);
    const std::vector<std::uint32_t> corners = pbrt_indices(p, 3, mesh.positions.size());
    for (std::size_t i = 0; i + 2 < corners.size(); i += 3)
        mesh.triangles.push_back({{corners[i], corners[i + 1], corners[i + 2]}});
    return mesh;
}

Mesh ply_mesh(const PbrtParameters& p, PbrtFiles& files, PbrtScene& scene) {
    const std::string name = p.string("filename", "");
    if (name.empty()) p.refuse("filename", "\"string filename\"", "none");
    std::vector<std::string> warnings;
    Mesh mesh;
    try {
        mesh = parse_ply(files.read(name, p.place()), name, warnings);
    } catch (const FileError& error) {
        const std::string place = p.place().text(), text = error.what();
        throw SceneError{text.starts_with(place) ? text : place + ": " + text};
    }
    for (const std::string& warning : warnings) scene.warn(p.place(), name + ": " + warning);
    mesh.colors.clear();  // pbrt has no vertex colours
    if (p.find_texture("displacement")) scene.warn(p.place(), "displacement of \"plymesh\" is not supported");
    p.ignore({"displacement.edgelength", "edgelength"});
    return mesh;
}

Vec3 corner_cross(const Mesh& mesh, const Triangle& t) {
    const Vec3 a = mesh.positions[t.vertex[0]];
    return cross(mesh.positions[t.vertex[1]] - a, mesh.positions[t.vertex[2]] - a);
}

/// Counter-clockwise seen from outside: where vertices have normals, those say where that is.
void orient(Mesh& mesh, bool reverse) {
    if (reverse)
        for (Vec3& n : mesh.normals) n = -n;
    for (Triangle& t : mesh.triangles) {
        bool turn = reverse;
        if (!mesh.normals.empty()) {
            const Vec3 n = mesh.normals[t.vertex[0]] + mesh.normals[t.vertex[1]] + mesh.normals[t.vertex[2]];
            const Vec3 c = corner_cross(mesh, t);
            const float l = max_abs(c);
            turn = l > 0 && dot(c / l, n) < 0;
        }
        if (turn) std::swap(t.vertex[1], t.vertex[2]);
    }
}

/// Every triangle gets corners of its own, at (0, 0), (1, 0) and (1, 1), as pbrt has it.
void add_default_uv(Mesh& mesh) {
    Mesh split;
    split.positions.reserve(3 * mesh.triangles.size());
    for (const Triangle& t : mesh.triangles) {
        const auto first = static_cast<std::uint32_t>(split.positions.size());
        for (const std::uint32_t vertex : t.vertex) {
            split.positions.push_back(mesh.positions[vertex]);
            if (!mesh.normals.empty()) split.normals.push_back(mesh.normals[vertex]);
        }
        for (const Vec2 uv : {Vec2{0, 1}, Vec2{1, 1}, Vec2{1, 0}}) split.uvs[0].push_back(uv);
        split.triangles.push_back({{first, first + 1, first + 2}});
    }
    mesh.positions = std::move(split.positions);
    mesh.normals = std::move(split.normals);
    mesh.uvs = std::move(split.uvs);
    mesh.triangles = std::move(split.triangles);
}

const std::vector<std::string> shape_types{"bilinearmesh", "curve",   "cylinder", "disk",
                                           "loopsubdiv",   "plymesh", "sphere",   "trianglemesh"};

Mesh make_mesh(const PbrtShape& shape, const PbrtDetail& detail, PbrtFiles& files, PbrtScene& scene) {
    const std::string& type = shape.entity.type;
    const PbrtParameters& p = shape.entity.parameters;
    if (type == "trianglemesh") return triangle_mesh(p, scene);
    if (type == "plymesh") return ply_mesh(p, files, scene);
    if (type == "sphere") return pbrt_sphere(p, detail);
    if (type == "disk") return pbrt_disk(p, detail);
    if (type == "cylinder") return pbrt_cylinder(p, detail);
    if (type == "bilinearmesh") return pbrt_bilinear_mesh(p, detail);
    if (type == "loopsubdiv") return pbrt_loop_subdivision(p);
    if (type != "curve")
        refuse_pbrt(p.place(), "a shape among " + one_of(shape_types),
                    quote(type) + did_you_mean(type, shape_types));
    scene.warn(p.place(), "shape \"curve\" is not supported and was left out");
    p.ignore({"P", "width", "width0", "width1", "type", "degree", "basis", "N", "splitdepth"});
    return {};
}

}  // namespace

bool is_pbrt_quadric(const std::string& type) {
    return type == "sphere" || type == "disk" || type == "cylinder";
}

std::vector<std::uint32_t> pbrt_indices(const PbrtParameters& p, std::size_t corners, std::size_t vertices) {
    std::vector<std::uint32_t> indices = p.indices("indices");
    if (indices.empty() && vertices == corners)
        for (std::uint32_t i = 0; i < corners; ++i) indices.push_back(i);
    if (indices.empty()) p.refuse("indices", "\"integer indices\"", "none");
    if (indices.size() % corners != 0)
        p.refuse("indices", fmt::format("a multiple of {} values", corners),
                 fmt::format("{}", indices.size()));
    for (const std::uint32_t i : indices)
        if (i >= vertices)
            p.refuse("indices", fmt::format("vertices below {}", vertices), fmt::format("{}", i));
    return indices;
}

Mesh make_pbrt_mesh(const PbrtShape& shape, const PbrtDetail& detail, bool needs_uv, PbrtFiles& files,
                    PbrtScene& scene) {
    const PbrtParameters& p = shape.entity.parameters;
    Mesh mesh = make_mesh(shape, detail, files, scene);
    p.ignore({"alpha"});
    p.finish();
    mesh.name = fmt::format("{} at {}", shape.entity.type, p.place().text());
    if (mesh.triangles.empty()) return {};
    orient(mesh, shape.reverse_orientation);
    if (needs_uv && mesh.uvs[0].empty()) add_default_uv(mesh);
    mesh.facet_tangents = !is_pbrt_quadric(shape.entity.type);
    return mesh;
}

}  // namespace relumine
