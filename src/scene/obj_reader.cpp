// SPDX-License-Identifier: Apache-2.0
// Reads Wavefront OBJ meshes with tinyobjloader, which gets only the lines that make up the mesh: it would
// open any material file, size arrays by what `t` lines claim, and read "nan" as 0.
#include <fmt/format.h>
#include <tiny_obj_loader.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <unordered_map>

#include "base/file.hpp"
#include "base/hash.hpp"
#include "base/message.hpp"
#include "relumine/error.hpp"
#include "scene/quote.hpp"
#include "scene/readers.hpp"

namespace relumine {
namespace {

constexpr std::string_view space = " \t\r";

/// What the filter saw.
struct ObjText {
    std::string text;  // the lines of the mesh; others are empty, so that line numbers stay
    bool has_materials = false, has_lines_or_points = false;
};

std::string_view first_word(std::string_view line) {
    const std::size_t begin = std::min(line.find_first_not_of(space), line.size());
    return line.substr(begin, line.find_first_of(space, begin) - begin);
}

/// The numbers of a `v`, `vn` or `vt` line: at least `count`, each beginning like one.
void check_numbers(std::string_view line, std::size_t count, const std::string& where) {
    std::size_t at = line.find_first_not_of(space);
    for (std::size_t i = 0; i < count; ++i) {
        at = line.find_first_not_of(space, std::min(line.find_first_of(space, at), line.size()));
        const std::string_view rest = at == line.npos ? "" : line.substr(at);
        const std::size_t sign = rest.find_first_not_of("+-.");
        if (sign == rest.npos || sign > 2 || rest[sign] < '0' || rest[sign] > '9')
            throw SceneError{
                expected_found(where, fmt::format("{} numbers", count), quote(first_word(rest)))};
    }
}

/// How many numbers a line of this kind needs; 0 for kinds that carry none.
std::size_t number_count(std::string_view kind) {
    return kind == "v" || kind == "vn" ? 3 : kind == "vt" ? 1 : 0;
}

ObjText filter(std::string_view all, const std::string& path) {
    ObjText result;
    result.text.reserve(all.size() + 1);
    for (std::size_t line_number = 1; !all.empty(); ++line_number) {
        const std::size_t end = std::min(all.find('\n'), all.size());
        const std::string_view line = all.substr(0, end);
        all.remove_prefix(std::min(end + 1, all.size()));
        const std::string_view kind = first_word(line);
        check_numbers(line, number_count(kind), fmt::format("{}:{}", path, line_number));
        if (number_count(kind) > 0 || kind == "f") result.text += line;
        result.text += '\n';
        result.has_materials = result.has_materials || kind == "mtllib" || kind == "usemtl";
        result.has_lines_or_points = result.has_lines_or_points || kind == "l" || kind == "p";
    }
    return result;
}

/// A corner's three indices.
struct Corner {
    int position, normal, uv;
    bool operator==(const Corner&) const = default;
};
struct CornerHash {
    std::size_t operator()(const Corner& c) const {
        return hash(static_cast<std::uint64_t>(c.position), static_cast<std::uint64_t>(c.normal),
                    static_cast<std::uint64_t>(c.uv));
    }
};

/// Joins OBJ's separate indices into vertices, in the order in which faces first use them.
class MeshBuilder {
  public:
    MeshBuilder(const tinyobj::attrib_t& attributes, const std::string& path)
        : attributes_(attributes),
          path_(path),
          has_normals_(!attributes.normals.empty()),
          has_uvs_(!attributes.texcoords.empty()) {}

    void add_face(std::span<const tinyobj::index_t> corners) {
        std::uint32_t first = 0, previous = 0;
        for (std::size_t i = 0; i < corners.size(); ++i) {
            const std::uint32_t vertex = add_vertex(corners[i]);
            if (i == 0) first = vertex;
            if (i >= 2) mesh_.triangles.push_back({{first, previous, vertex}});
            previous = vertex;
        }
    }
    [[nodiscard]] Mesh take() {
        if (!has_normals_) mesh_.normals.clear();  // some corners lacked them: all are computed
        if (!has_uvs_) mesh_.uvs[0].clear();
        return std::move(mesh_);
    }

  private:
    std::uint32_t add_vertex(const tinyobj::index_t& i) {
        const Corner corner{
            checked(i.vertex_index, attributes_.vertices.size() / 3, "vertex"),
            i.normal_index < 0 ? -1 : checked(i.normal_index, attributes_.normals.size() / 3, "normal"),
            i.texcoord_index < 0 ? -1 : checked(i.texcoord_index, attributes_.texcoords.size() / 2, "uv")};
        const auto [it, inserted] =
            vertices_.try_emplace(corner, static_cast<std::uint32_t>(mesh_.positions.size()));
        if (inserted) append(corner);
        return it->second;
    }

    int checked(int i, std::size_t size, std::string_view what) const {
        if (i < 0 || static_cast<std::size_t>(i) >= size)
            throw SceneError{expected_found(path_, fmt::format("{} indices from 1 to {}", what, size),
                                            fmt::format("{}", static_cast<long>(i) + 1))};
        return i;
    }

    void append(const Corner& corner) {
        const auto p = static_cast<std::size_t>(corner.position) * 3;
        mesh_.positions.push_back(
            {attributes_.vertices[p], attributes_.vertices[p + 1], attributes_.vertices[p + 2]});
        has_normals_ = has_normals_ && corner.normal >= 0;
        if (has_normals_) {
            const auto n = static_cast<std::size_t>(corner.normal) * 3;
            mesh_.normals.push_back(
                {attributes_.normals[n], attributes_.normals[n + 1], attributes_.normals[n + 2]});
        }
        has_uvs_ = has_uvs_ && corner.uv >= 0;
        if (has_uvs_) {
            const auto t = static_cast<std::size_t>(corner.uv) * 2;
            mesh_.uvs[0].push_back(
                {attributes_.texcoords[t], 1 - attributes_.texcoords[t + 1]});  // v grows upwards
        }
    }

    const tinyobj::attrib_t& attributes_;
    const std::string& path_;
    bool has_normals_, has_uvs_;                                      // of every corner so far
    std::unordered_map<Corner, std::uint32_t, CornerHash> vertices_;  // looked up only, never walked
    Mesh mesh_;
};

Mesh build_mesh(const tinyobj::ObjReader& reader, const std::string& path) {
    MeshBuilder builder{reader.GetAttrib(), path};
    for (const tinyobj::shape_t& shape : reader.GetShapes()) {
        std::span<const tinyobj::index_t> rest{shape.mesh.indices};
        for (const std::size_t corners : shape.mesh.num_face_vertices) {
            if (corners < 3 || corners > rest.size())
                throw SceneError{
                    expected_found(path, "faces of 3 to 255 corners", fmt::format("{}", corners))};
            builder.add_face(rest.first(corners));
            rest = rest.subspan(corners);
        }
        if (!rest.empty()) throw SceneError{expected_found(path, "faces of 3 to 255 corners", "more")};
    }
    return builder.take();
}

}  // namespace

Mesh read_obj(const std::string& path, std::vector<std::string>& warnings) {
    std::vector<std::uint8_t> bytes = read_file(path);
    if (is_gzip(bytes)) bytes = unpack_gzip(bytes, path);
    const ObjText obj = filter({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, path);
    if (obj.has_materials) warnings.push_back("materials of OBJ files are not supported and were ignored");
    if (obj.has_lines_or_points) warnings.push_back("points and lines are not rendered");
    tinyobj::ObjReaderConfig config;
    config.triangulate = false;  // we do, with checked indices
    config.vertex_color = false;
    tinyobj::ObjReader reader;
    if (!reader.ParseFromString(obj.text, "", config))
        throw SceneError{expected_found(path, "a valid OBJ file",
                                        quote(reader.Error().substr(0, reader.Error().find('\n'))))};
    if (reader.Warning().find("Degenerated face") != std::string::npos)
        warnings.push_back("faces with fewer than three corners were left out");
    Mesh mesh = build_mesh(reader, path);
    mesh.name = path;
    return mesh;
}

}  // namespace relumine
