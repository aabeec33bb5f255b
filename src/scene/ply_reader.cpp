// SPDX-License-Identifier: Apache-2.0
// Reads PLY meshes: text or binary, properties in any order and of any type, packed with gzip or not.
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <string_view>

#include "base/file.hpp"
#include "base/message.hpp"
#include "image/srgb.hpp"
#include "relumine/error.hpp"
#include "scene/ply_source.hpp"
#include "scene/quote.hpp"
#include "scene/readers.hpp"

namespace relumine {
namespace {

/// What a vertex property means. `ignored` collects the rest.
enum Slot : std::size_t { px, py, pz, nx, ny, nz, tu, tv, red, green, blue, alpha, ignored, slot_count };

constexpr std::array<std::pair<std::string_view, Slot>, 20> slot_names{{
    {"x", px},
    {"y", py},
    {"z", pz},
    {"nx", nx},
    {"ny", ny},
    {"nz", nz},
    {"u", tu},
    {"v", tv},
    {"s", tu},
    {"t", tv},
    {"texture_u", tu},
    {"texture_v", tv},
    {"texture_s", tu},
    {"texture_t", tv},
    {"red", red},
    {"green", green},
    {"blue", blue},
    {"alpha", alpha},
    {"diffuse_red", ignored},
    {"", ignored},
}};

Slot slot_of(std::string_view name) {
    for (const auto& [slot_name, slot] : slot_names)
        if (slot_name == name) return slot;
    return ignored;
}

/// The vertex properties of one file.
struct VertexLayout {
    std::vector<Slot> slots;  // by property
    std::array<bool, slot_count> has{};
    float color_unit = 1;  // what full intensity is stored as
    bool srgb = false;     // integer colours are sRGB, floating-point ones linear

    [[nodiscard]] bool has_all(std::initializer_list<Slot> wanted) const {
        return std::ranges::all_of(wanted, [&](Slot slot) { return has[slot]; });
    }
};

VertexLayout vertex_layout(const PlyElement& element, const std::string& path) {
    VertexLayout layout;
    for (const PlyProperty& property : element.properties) {
        const Slot slot = property.list ? ignored : slot_of(property.name);
        layout.slots.push_back(slot);
        layout.has[slot] = true;
        if (slot == red && (property.type == PlyType::uint8 || property.type == PlyType::uint16)) {
            layout.srgb = true;
            layout.color_unit = property.type == PlyType::uint8 ? 255.0f : 65535.0f;
        }
    }
    if (!layout.has_all({px, py, pz}))
        throw SceneError{expected_found(path + ": element vertex", "properties x, y and z", "others")};
    return layout;
}

float linear_color(double stored, const VertexLayout& layout) {
    const double value = stored / static_cast<double>(layout.color_unit);
    return static_cast<float>(layout.srgb ? linear_from_srgb(value) : value);
}

/// Reads the body of a file from text or from either byte order.
template <typename Source>
class BodyReader {
  public:
    BodyReader(const PlyHeader& header, Source source, const std::string& path,
               std::vector<std::string>& warnings)
        : header_(header), source_(source), path_(path), warnings_(warnings) {}

    [[nodiscard]] Mesh read() {
        for (const PlyElement& element : header_.elements) {
            check_count(element);
            if (element.name == "vertex")
                read_vertices(element);
            else if (element.name == "face")
                read_faces(element);
            else
                skip(element);
        }
        check_indices();
        return std::move(mesh_);
    }

  private:
    /// A count that the rest of the file cannot hold must not size an allocation.
    void check_count(const PlyElement& element) {
        std::size_t smallest = 0;  // bytes of one element
        for (const PlyProperty& property : element.properties)
            smallest += Source::smallest_size(property.list ? property.count_type : property.type);
        const std::uint64_t most = smallest == 0 ? 0 : (source_.bytes_left() + 1) / smallest;
        if (element.count > most && !element.properties.empty())
            throw SceneError{expected_found(path_ + ": element " + quote(element.name),
                                            fmt::format("at most {} in a file of this size", most),
                                            fmt::format("{}", element.count))};
        if (element.name == "tristrips" && element.count > 0)
            throw SceneError{expected_found(path_, "faces", "triangle strips, which are not supported")};
    }

    std::size_t list_length(const PlyProperty& property) {
        const double length = source_.next(property.count_type);
        const double most = static_cast<double>(source_.bytes_left() + 1)
                            / static_cast<double>(Source::smallest_size(property.type));
        if (!(length >= 0 && length <= most))
            source_.refuse(fmt::format("a list of 0 to {:.0f} values", most), fmt::format("{:.0f}", length));
        return static_cast<std::size_t>(length);
    }

    void skip(const PlyProperty& property) {
        const std::size_t count = property.list ? list_length(property) : 1;
        for (std::size_t i = 0; i < count; ++i) (void)source_.next(property.type);
    }
    void skip(const PlyElement& element) {
        if (element.properties.empty()) return;
        for (std::uint64_t i = 0; i < element.count; ++i)
            for (const PlyProperty& property : element.properties) skip(property);
    }

    void read_vertices(const PlyElement& element) {
        const VertexLayout layout = vertex_layout(element, path_);
        const auto reserve = [&](auto& attribute, std::initializer_list<Slot> slots) {
            if (layout.has_all(slots)) attribute.reserve(static_cast<std::size_t>(element.count));
        };
        reserve(mesh_.positions, {px});
        reserve(mesh_.normals, {nx, ny, nz});
        reserve(mesh_.uvs[0], {tu, tv});
        reserve(mesh_.colors, {red, green, blue});
        for (std::uint64_t i = 0; i < element.count; ++i) read_vertex(element, layout);
    }

    void read_vertex(const PlyElement& element, const VertexLayout& layout) {
        std::array<double, slot_count> value{};
        for (std::size_t i = 0; i < element.properties.size(); ++i) {
            if (element.properties[i].list)
                skip(element.properties[i]);
            else
                value[layout.slots[i]] = source_.next(element.properties[i].type);
        }
        const auto f = [&](Slot slot) { return static_cast<float>(value[slot]); };
        mesh_.positions.push_back({f(px), f(py), f(pz)});
        if (layout.has_all({nx, ny, nz})) mesh_.normals.push_back({f(nx), f(ny), f(nz)});
        if (layout.has_all({tu, tv})) mesh_.uvs[0].push_back({f(tu), 1 - f(tv)});  // v grows upwards in PLY
        if (layout.has_all({red, green, blue}))
            mesh_.colors.push_back({linear_color(value[red], layout), linear_color(value[green], layout),
                                    linear_color(value[blue], layout),
                                    layout.has[alpha] ? f(alpha) / layout.color_unit : 1.0f});
    }

    void read_faces(const PlyElement& element) {
        mesh_.triangles.reserve(static_cast<std::size_t>(element.count));
        bool found = false;
        for (const PlyProperty& property : element.properties) found = found || is_corner_list(property);
        if (!found)
            throw SceneError{
                expected_found(path_ + ": element face", "a list vertex_indices or vertex_index", "none")};
        std::size_t too_small = 0;
        for (std::uint64_t i = 0; i < element.count; ++i) {
            for (const PlyProperty& property : element.properties) {
                if (!is_corner_list(property))
                    skip(property);
                else if (!read_polygon(property))
                    ++too_small;
            }
        }
        if (too_small > 0)
            warnings_.push_back(
                fmt::format("{} faces with fewer than three corners were left out", too_small));
    }

    static bool is_corner_list(const PlyProperty& property) {
        return property.list && (property.name == "vertex_indices" || property.name == "vertex_index");
    }

    /// Cuts the polygon into a fan; false where it has fewer than three corners.
    bool read_polygon(const PlyProperty& property) {
        const std::size_t count = list_length(property);
        std::uint32_t first = 0, previous = 0;
        for (std::size_t i = 0; i < count; ++i) {
            const std::uint32_t corner = read_index(property);
            if (i == 0) first = corner;
            if (i >= 2) mesh_.triangles.push_back({{first, previous, corner}});
            previous = corner;
        }
        return count >= 3;
    }

    std::uint32_t read_index(const PlyProperty& property) {
        const double corner = source_.next(property.type);
        if (!(corner >= 0 && corner <= 4294967294.0 && corner == std::floor(corner)))
            source_.refuse("the index of a vertex", fmt::format("{:g}", corner));
        return static_cast<std::uint32_t>(corner);
    }

    void check_indices() const {
        for (std::size_t i = 0; i < mesh_.triangles.size(); ++i)
            for (const std::uint32_t vertex : mesh_.triangles[i].vertex)
                if (vertex >= mesh_.positions.size())
                    throw SceneError{expected_found(fmt::format("{}: triangle {}", path_, i),
                                                    fmt::format("vertices below {}", mesh_.positions.size()),
                                                    fmt::format("{}", vertex))};
    }

    const PlyHeader& header_;
    Source source_;
    const std::string& path_;
    std::vector<std::string>& warnings_;
    Mesh mesh_;
};

template <typename Source>
Mesh read_body(const PlyHeader& header, std::span<const std::uint8_t> bytes, const std::string& path,
               std::vector<std::string>& warnings) {
    return BodyReader<Source>{header, Source{bytes, path}, path, warnings}.read();
}

}  // namespace

Mesh read_ply(const std::string& path, std::vector<std::string>& warnings) {
    std::vector<std::uint8_t> bytes = read_file(path);
    if (is_gzip(bytes)) bytes = unpack_gzip(bytes, path);
    return parse_ply(bytes, path, warnings);
}

Mesh parse_ply(std::span<const std::uint8_t> bytes, const std::string& path,
               std::vector<std::string>& warnings) {
    const PlyHeader header = parse_ply_header(bytes, path);
    const auto body = bytes.subspan(header.body);
    Mesh mesh;
    switch (header.format) {
        case PlyFormat::ascii:
            mesh = read_body<PlyText>(header, body, path, warnings);
            break;
        case PlyFormat::little_endian:
            mesh = read_body<PlyBinary<std::endian::little>>(header, body, path, warnings);
            break;
        case PlyFormat::big_endian:
            mesh = read_body<PlyBinary<std::endian::big>>(header, body, path, warnings);
            break;
    }
    mesh.name = path;
    return mesh;
}

}  // namespace relumine
