// SPDX-License-Identifier: Apache-2.0
// Meshes of a glTF file.
#include "scene/gltf_mesh.hpp"

#include <fmt/format.h>

#include <cstring>
#include <numeric>

#include "base/message.hpp"
#include "relumine/error.hpp"
#include "scene/gltf_accessor.hpp"
#include "scene/gltf_draco.hpp"
#include "scene/quote.hpp"

namespace relumine {
namespace {

/// One primitive and how messages call it.
struct PrimitiveRef {
    const GltfFile& file;
    const tinygltf::Primitive& primitive;
    std::string place;                       // "meshes[2].primitives[0]"
    const DracoPrimitive* packed = nullptr;  // what of it was compressed
};

/// The accessor of an attribute, or −1.
int attribute(const PrimitiveRef& ref, const std::string& name) {
    const auto it = ref.primitive.attributes.find(name);
    return it == ref.primitive.attributes.end() ? -1 : it->second;
}

/// `T` is a struct of `components` floats, e.g. Vec3.
template <typename T>
std::vector<T> as_vectors(const std::vector<float>& floats) {
    std::vector<T> vectors(floats.size() * sizeof(float) / sizeof(T));
    if (!vectors.empty())
        std::memcpy(static_cast<void*>(vectors.data()), floats.data(), vectors.size() * sizeof(T));
    return vectors;
}

const std::vector<float>& packed_values(const PrimitiveRef& ref, const std::string& name, int components) {
    const auto& attribute = ref.packed->attributes.at(name);
    if (attribute.components != components)
        throw SceneError{expected_found(ref.file.where(ref.place + '.' + name),
                                        fmt::format("{} components in the Draco data", components),
                                        fmt::format("{}", attribute.components))};
    return attribute.values;
}

/// The attribute's values, one per vertex; empty where the primitive does not have it.
template <typename T>
std::vector<T> read_attribute(const PrimitiveRef& ref, const std::string& name, std::size_t vertices) {
    const int accessor = attribute(ref, name);
    if (accessor < 0) return {};
    const int components = static_cast<int>(sizeof(T) / sizeof(float));
    if (ref.packed != nullptr && ref.packed->attributes.contains(name))
        return as_vectors<T>(packed_values(ref, name, components));
    const std::size_t count = ref.file.model.accessors[to_size(accessor)].count;
    if (count != vertices)
        throw SceneError{expected_found(ref.file.where(ref.place + '.' + name),
                                        fmt::format("{} elements, as POSITION has", vertices),
                                        fmt::format("{}", count))};
    return as_vectors<T>(read_floats(ref.file, accessor, components));
}

/// COLOR_0 as RGBA; opaque where it is RGB.
std::vector<std::array<float, 4>> read_colors(const PrimitiveRef& ref, std::size_t vertices) {
    const int accessor = attribute(ref, "COLOR_0");
    if (accessor < 0 || component_count(ref.file, accessor) != 3)
        return read_attribute<std::array<float, 4>>(ref, "COLOR_0", vertices);
    std::vector<std::array<float, 4>> colors;
    colors.reserve(vertices);
    for (const Vec3 c : read_attribute<Vec3>(ref, "COLOR_0", vertices)) colors.push_back({c.x, c.y, c.z, 1});
    return colors;
}

std::vector<Triangle> list_triangles(const PrimitiveRef& ref, const std::vector<std::uint32_t>& corners) {
    if (corners.size() % 3 != 0)
        throw SceneError{expected_found(ref.file.where(ref.place), "a multiple of 3 indices",
                                        fmt::format("{}", corners.size()))};
    std::vector<Triangle> triangles(corners.size() / 3);
    for (std::size_t i = 0; i < triangles.size(); ++i)
        triangles[i] = {{corners[3 * i], corners[3 * i + 1], corners[3 * i + 2]}};
    return triangles;
}

std::vector<Triangle> strip_triangles(const std::vector<std::uint32_t>& corners) {
    std::vector<Triangle> triangles;
    for (std::size_t i = 0; i + 2 < corners.size(); ++i)  // every other triangle turns, to keep the side
        triangles.push_back({{corners[i], corners[i + 1 + i % 2], corners[i + 2 - i % 2]}});
    return triangles;
}

std::vector<Triangle> fan_triangles(const std::vector<std::uint32_t>& corners) {
    std::vector<Triangle> triangles;
    for (std::size_t i = 1; i + 1 < corners.size(); ++i)
        triangles.push_back({{corners[i], corners[i + 1], corners[0]}});
    return triangles;
}

std::vector<Triangle> read_triangles(const PrimitiveRef& ref, std::size_t vertices) {
    if (ref.packed != nullptr) return list_triangles(ref, ref.packed->corners);
    std::vector<std::uint32_t> corners;
    if (ref.primitive.indices >= 0) {
        corners = read_indices(ref.file, ref.primitive.indices);
    } else {
        corners.resize(vertices);
        std::iota(corners.begin(), corners.end(), 0u);
    }
    switch (ref.primitive.mode) {
        case TINYGLTF_MODE_TRIANGLE_STRIP:
            return strip_triangles(corners);
        case TINYGLTF_MODE_TRIANGLE_FAN:
            return fan_triangles(corners);
        default:
            return list_triangles(ref, corners);
    }
}

void spend(GltfBudget& budget, const PrimitiveRef& ref, std::size_t count) {
    if (count > budget.elements)
        throw SceneError{
            expected_found(ref.file.where(ref.place), "at most 2^30 vertices and indices in all", "more")};
    budget.elements -= count;
}

Mesh read_primitive(PrimitiveRef ref, GltfBudget& budget) {
    const int position = attribute(ref, "POSITION");
    const auto count = [&](int accessor) {
        return accessor < 0 ? 0 : ref.file.model.accessors[to_size(accessor)].count;
    };
    const std::size_t vertices = count(position);
    spend(budget, ref, vertices);
    spend(budget, ref, count(ref.primitive.indices));
    const auto packed = unpack_gltf_primitive(ref.file, ref.primitive, ref.place);
    if (packed && packed->points != vertices)
        throw SceneError{expected_found(ref.file.where(ref.place),
                                        fmt::format("{} points in the Draco data, as POSITION has", vertices),
                                        fmt::format("{}", packed->points))};
    if (packed) ref.packed = &*packed;
    if (packed) spend(budget, ref, packed->corners.size());
    const int material = ref.primitive.material;
    Mesh mesh;
    mesh.positions = read_attribute<Vec3>(ref, "POSITION", vertices);
    mesh.normals = read_attribute<Vec3>(ref, "NORMAL", vertices);
    mesh.tangents = read_attribute<Vec4>(ref, "TANGENT", vertices);
    mesh.uvs = {read_attribute<Vec2>(ref, "TEXCOORD_0", vertices),
                read_attribute<Vec2>(ref, "TEXCOORD_1", vertices)};
    mesh.colors = read_colors(ref, vertices);
    mesh.triangles = read_triangles(ref, vertices);
    mesh.material =
        static_cast<MaterialId>(material < 0 ? ref.file.model.materials.size() : to_size(material));
    return mesh;
}

/// Why this primitive cannot be rendered, or "".
std::string not_renderable(const PrimitiveRef& ref) {
    if (ref.primitive.mode < TINYGLTF_MODE_TRIANGLES) return "points and lines are not rendered";
    if (attribute(ref, "POSITION") < 0) return "it has no POSITION and was left out";
    return "";
}

}  // namespace

std::vector<Mesh> read_gltf_mesh(const GltfFile& file, int mesh, GltfBudget& budget, SceneData& scene) {
    const auto& source = file.model.meshes[to_size(mesh)];
    const std::string name = source.name.empty() ? fmt::format("mesh {}", mesh) : source.name;
    std::vector<Mesh> meshes;
    for (std::size_t i = 0; i < source.primitives.size(); ++i) {
        const std::string place = fmt::format("meshes[{}].primitives[{}]", mesh, i);
        const PrimitiveRef ref{file, source.primitives[i], place};
        if (const auto reason = not_renderable(ref); !reason.empty()) {
            scene.warn(fmt::format("{} of {}: {}", place, quote(name), reason));
            continue;
        }
        meshes.push_back(read_primitive(ref, budget));
        meshes.back().name = source.primitives.size() == 1 ? name : fmt::format("{} {}", name, i);
    }
    return meshes;
}

}  // namespace relumine
