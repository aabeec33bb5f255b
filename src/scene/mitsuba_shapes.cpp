// SPDX-License-Identifier: Apache-2.0
// Mitsuba's shapes: files, quadrics, rectangle and cube; sides and texture coordinates.
#include "scene/mitsuba_shapes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/message.hpp"
#include "relumine/error.hpp"
#include "scene/mesh_normals.hpp"
#include "scene/pbrt_transform.hpp"
#include "scene/quote.hpp"
#include "scene/readers.hpp"

namespace relumine {
namespace {

const std::vector<std::string> shape_types{"cube", "cylinder",  "disk",       "instance",   "obj",
                                           "ply",  "rectangle", "serialized", "shapegroup", "sphere"};

PbrtParameters with(double radius, std::initializer_list<std::pair<const char*, double>> more,
                    const PbrtPlace& place) {
    std::vector<PbrtParameter> parameters;
    const auto add = [&](const char* name, double value) {
        PbrtParameter p;
        p.type = "float";
        p.name = name;
        p.place = place;
        p.numbers = {value};
        parameters.push_back(std::move(p));
    };
    add("radius", radius);
    for (const auto& [name, value] : more) add(name, value);
    return {"shape", place, std::move(parameters)};
}

MitsubaMesh sphere(MitsubaProperties& p, const PbrtDetail& detail) {
    const double radius = p.number("radius", 1);
    if (!(radius > 0)) p.refuse("radius", "a radius above 0", fmt::format("{:g}", radius));
    const std::array<double, 3> center = p.vector("center", {0, 0, 0});
    return {pbrt_sphere(with(1, {}, p.object().place), detail),
            pbrt_translate(center) * pbrt_scale({radius, radius, radius})};
}

/// u along the radius, v along the angle.
MitsubaMesh disk(MitsubaProperties& p, const PbrtDetail& detail) {
    Mesh mesh = pbrt_disk(with(1, {}, p.object().place), detail);
    for (Vec2& uv : mesh.uvs[0]) uv = {uv.y, uv.x};
    return {std::move(mesh), {}};
}

/// From p0 to p1, turned about its axis as Mitsuba turns it.
MitsubaMesh cylinder(MitsubaProperties& p, const PbrtDetail& detail) {
    const double radius = p.number("radius", 1);
    if (!(radius > 0)) p.refuse("radius", "a radius above 0", fmt::format("{:g}", radius));
    const std::array<double, 3> a = p.vector("p0", {0, 0, 0}), b = p.vector("p1", {0, 0, 1});
    std::array<double, 3> d{b[0] - a[0], b[1] - a[1], b[2] - a[2]};
    const double length = std::hypot(d[0], d[1], d[2]);
    if (!(length > 1e-30 && length < 1e30)) p.refuse("p1", "p0 and p1 apart", "the same point");
    for (double& c : d) c /= length;
    const auto [s, t] = mitsuba_frame(d);
    Transform along;
    for (std::size_t i = 0; i < 3; ++i) along.m[i] = {s[i] * radius, t[i] * radius, d[i] * length, a[i]};
    Mesh mesh = pbrt_cylinder(with(1, {{"zmin", 0}, {"zmax", 1}}, p.object().place), detail);
    for (Vec2& uv : mesh.uvs[0]) uv.y = 1 - uv.y;
    return {std::move(mesh), along};
}

/// [−1, 1]² in the plane z = 0, facing +Z.
MitsubaMesh rectangle() {
    Mesh mesh;
    mesh.positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
    mesh.normals.assign(4, {0, 0, 1});
    mesh.uvs[0] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    mesh.triangles = {{{0, 1, 2}}, {{2, 3, 0}}};
    return {std::move(mesh), {}};
}

/// [−1, 1]³: four corners and the normal of each side, in Mitsuba's order.
MitsubaMesh cube() {
    static constexpr std::array<std::array<float, 15>, 6> sides{{
        {1, -1, -1, 1, -1, 1, -1, -1, 1, -1, -1, -1, 0, -1, 0},
        {1, 1, -1, -1, 1, -1, -1, 1, 1, 1, 1, 1, 0, 1, 0},
        {1, -1, -1, 1, 1, -1, 1, 1, 1, 1, -1, 1, 1, 0, 0},
        {1, -1, 1, 1, 1, 1, -1, 1, 1, -1, -1, 1, 0, 0, 1},
        {-1, -1, 1, -1, 1, 1, -1, 1, -1, -1, -1, -1, -1, 0, 0},
        {1, 1, -1, 1, -1, -1, -1, -1, -1, -1, 1, -1, 0, 0, -1},
    }};
    Mesh mesh;
    for (const auto& side : sides) {
        const auto first = static_cast<std::uint32_t>(mesh.positions.size());
        for (std::size_t i = 0; i < 4; ++i) {
            mesh.positions.push_back({side[3 * i], side[3 * i + 1], side[3 * i + 2]});
            mesh.normals.push_back({side[12], side[13], side[14]});
        }
        for (const Vec2 uv : {Vec2{0, 1}, {1, 1}, {1, 0}, {0, 0}}) mesh.uvs[0].push_back(uv);
        mesh.triangles.push_back({{first, first + 1, first + 2}});
        mesh.triangles.push_back({{first + 3, first, first + 2}});
    }
    return {std::move(mesh), {}};
}

void flip_v(Mesh& mesh) {
    for (Vec2& uv : mesh.uvs[0]) uv.y = 1 - uv.y;
}

/// obj, ply, serialized. Our readers of OBJ and PLY turn v around, as Mitsuba does for OBJ alone.
MitsubaMesh from_file(MitsubaProperties& p) {
    const std::string& type = p.object().type;
    const PbrtPlace& place = p.object().place;
    const std::string name = p.string("filename", "");
    if (name.empty()) p.refuse("filename", "<string name=\"filename\">", "none");
    const bool flip = p.boolean("flip_tex_coords", type == "obj");
    std::vector<std::string> warnings;
    Mesh mesh;
    try {
        if (type == "obj")
            mesh = read_obj(p.scene().files.resolve(name, place), warnings);
        else if (type == "ply")
            mesh = parse_ply(p.scene().files.read(name, place), name, warnings);
        else
            mesh = parse_serialized(p.scene().files.read(name, place),
                                    static_cast<std::size_t>(std::max(0, p.integer("shape_index", 0))), name);
    } catch (const FileError& error) {
        const std::string where = place.text(), text = error.what();
        throw SceneError{text.starts_with(where) ? text : where + ": " + text};
    }
    for (const std::string& warning : warnings) p.warn(name + ": " + warning);
    if (flip == (type == "serialized")) flip_v(mesh);
    mesh.colors.clear();
    if (p.boolean("face_normals", false))
        mesh.normals.clear();
    else if (mesh.normals.empty() && !mesh.triangles.empty())
        mesh.normals = mean_normals(mesh);
    return {std::move(mesh), {}};
}

void turn_inside_out(Mesh& mesh) {
    for (Triangle& t : mesh.triangles) std::swap(t.vertex[1], t.vertex[2]);
    for (Vec3& n : mesh.normals) n = -n;
}

}  // namespace

bool is_mitsuba_curved(const std::string& type) { return is_pbrt_quadric(type); }

MitsubaMesh make_mitsuba_mesh(MitsubaProperties& p, const PbrtDetail& detail) {
    const std::string& type = p.object().type;
    MitsubaMesh made;
    if (type == "sphere")
        made = sphere(p, detail);
    else if (type == "disk")
        made = disk(p, detail);
    else if (type == "cylinder")
        made = cylinder(p, detail);
    else if (type == "rectangle")
        made = rectangle();
    else if (type == "cube")
        made = cube();
    else if (type == "obj" || type == "ply" || type == "serialized")
        made = from_file(p);
    else
        refuse_pbrt(p.object().place, "a shape among " + one_of(shape_types),
                    quote(type) + did_you_mean(type, shape_types));
    if (p.boolean("flip_normals", false)) turn_inside_out(made.mesh);
    return made;
}

}  // namespace relumine
