// SPDX-License-Identifier: Apache-2.0
// Unpacking by Draco, which takes memory for as many points and faces as its data claim: so we read the
// claims first.
#include "scene/gltf_draco.hpp"

#include <draco/compression/decode.h>
#include <fmt/format.h>

#include <algorithm>
#include <exception>

#include "base/message.hpp"
#include "relumine/error.hpp"
#include "scene/gltf_accessor.hpp"
#include "scene/quote.hpp"

namespace relumine {
namespace {

constexpr std::size_t densest =
    16;  // points or faces in one byte, far more than Draco reaches on smooth meshes
constexpr std::size_t allowance = 4096;
constexpr std::size_t most_attributes = 32;

/// Reads the header of Draco's bitstream 2.2; `failed` once the data end.
class Header {
  public:
    explicit Header(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

    std::uint8_t byte() {
        if (at_ >= bytes_.size()) {
            failed = true;
            return 0;
        }
        return bytes_[at_++];
    }
    /// Seven bits in each byte, the least first.
    std::uint64_t varint() {
        std::uint64_t value = 0;
        for (int shift = 0; shift < 35; shift += 7) {
            const std::uint8_t b = byte();
            value |= std::uint64_t{b & 0x7fu} << shift;
            if ((b & 0x80u) == 0) return value;
        }
        failed = true;
        return value;
    }

    bool failed = false;

  private:
    std::span<const std::uint8_t> bytes_;
    std::size_t at_ = 0;
};

[[noreturn]] void refuse(const std::string& where, const std::string& expected, const std::string& found) {
    throw SceneError{expected_found(where, expected, found)};
}

/// What the data claim to hold.
void check_claims(std::span<const std::uint8_t> bytes, const std::string& where) {
    Header header{bytes};
    std::string magic;
    for (int i = 0; i < 5; ++i) magic += static_cast<char>(header.byte());
    const int major = header.byte(), minor = header.byte(), geometry = header.byte(), method = header.byte();
    const int flags = header.byte() | header.byte() << 8;
    if (header.failed || magic != "DRACO") refuse(where, "Draco data", quote(magic));
    if (major != 2 || minor != 2)
        refuse(where, "Draco bitstream 2.2, as the extension asks", fmt::format("{}.{}", major, minor));
    if (geometry != 1 || method > 1) refuse(where, "a Draco mesh", "another geometry");
    if ((flags & 0x8000) != 0) refuse(where, "a Draco mesh without metadata", "metadata");
    if (method == 1) (void)header.byte();  // how the surface is walked
    const std::uint64_t first = header.varint(),
                        second = header.varint();  // faces and points, in either order
    if (header.failed) refuse(where, "the numbers of points and faces", "the end of the data");
    const std::size_t most = densest * bytes.size() + allowance;
    if (std::max(first, second) > most)
        refuse(where, fmt::format("at most {} points and faces in {} bytes", most, bytes.size()),
               fmt::format("{}", std::max(first, second)));
}

std::unique_ptr<draco::Mesh> decode(std::span<const std::uint8_t> bytes, const std::string& where) {
    check_claims(bytes, where);
    draco::DecoderBuffer buffer;
    buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    try {
        draco::Decoder decoder;
        auto result = decoder.DecodeMeshFromBuffer(&buffer);
        if (!result.ok()) refuse(where, "valid Draco data", quote(result.status().error_msg_string()));
        return std::move(result).value();
    } catch (const SceneError&) {
        throw;
    } catch (const std::exception& error) {
        refuse(where, "valid Draco data", quote(error.what()));
    }
}

float largest(int component_type) {
    switch (component_type) {
        case TINYGLTF_COMPONENT_TYPE_BYTE:
            return 127;
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
            return 255;
        case TINYGLTF_COMPONENT_TYPE_SHORT:
            return 32767;
        default:
            return 65535;
    }
}

DracoPrimitive::Attribute read_attribute(const draco::Mesh& mesh, const draco::PointAttribute& source,
                                         const tinygltf::Accessor& accessor, const std::string& where) {
    DracoPrimitive::Attribute attribute;
    attribute.components = source.num_components();
    if (attribute.components < 1 || attribute.components > 4)
        refuse(where, "1 to 4 components", fmt::format("{}", attribute.components));
    const auto components = to_size(attribute.components);
    attribute.values.resize(components * mesh.num_points());
    const bool scale = accessor.normalized && !source.normalized() && source.data_type() != draco::DT_FLOAT32;
    const float unit = scale ? largest(accessor.componentType) : 1.0f;
    for (std::uint32_t i = 0; i < mesh.num_points(); ++i) {
        float* const out = &attribute.values[components * i];
        const auto entry = source.mapped_index(draco::PointIndex(i));
        if (entry.value() >= source.size()
            || !source.ConvertValue<float>(entry, source.num_components(), out))
            refuse(where, "a value for every point", fmt::format("none for point {}", i));
        for (std::size_t c = 0; c < components; ++c)
            out[c] = std::max(out[c] / unit, scale ? -1.0f : out[c] / unit);
    }
    return attribute;
}

void read_attributes(const GltfFile& file, const tinygltf::Primitive& primitive, const tinygltf::Value& ids,
                     const draco::Mesh& mesh, const std::string& place, DracoPrimitive& out) {
    if (ids.Keys().size() > most_attributes)
        refuse(file.where(place + ".attributes"), fmt::format("at most {} attributes", most_attributes),
               fmt::format("{}", ids.Keys().size()));
    for (const std::string& name : ids.Keys()) {
        const std::string where = file.where(fmt::format("{}.attributes.{}", place, quote(name)));
        const auto accessor = primitive.attributes.find(name);
        if (accessor == primitive.attributes.end()) refuse(where, "an attribute of the primitive", "none");
        const auto id = static_cast<std::uint32_t>(ids.Get(name).GetNumberAsInt());
        const draco::PointAttribute* const source = mesh.GetAttributeByUniqueId(id);
        if (source == nullptr)
            refuse(where, "the id of an attribute in the Draco data", fmt::format("{}", id));
        out.attributes[name] =
            read_attribute(mesh, *source, file.model.accessors[to_size(accessor->second)], where);
    }
}

void read_corners(const draco::Mesh& mesh, const std::string& where, DracoPrimitive& out) {
    out.corners.reserve(std::size_t{3} * mesh.num_faces());
    for (std::uint32_t i = 0; i < mesh.num_faces(); ++i)
        for (const draco::PointIndex& corner : mesh.face(draco::FaceIndex(i))) {
            if (corner.value() >= mesh.num_points())
                refuse(where, fmt::format("corners below {}", mesh.num_points()),
                       fmt::format("{}", corner.value()));
            out.corners.push_back(corner.value());
        }
}

}  // namespace

std::optional<DracoPrimitive> unpack_gltf_primitive(const GltfFile& file,
                                                    const tinygltf::Primitive& primitive,
                                                    const std::string& place) {
    const auto it = primitive.extensions.find("KHR_draco_mesh_compression");
    if (it == primitive.extensions.end()) return std::nullopt;
    const std::string here = place + ".extensions.KHR_draco_mesh_compression", where = file.where(here);
    if (primitive.mode != TINYGLTF_MODE_TRIANGLES)
        refuse(file.where(place + ".mode"), "4, triangles, where Draco packs them",
               fmt::format("{}", primitive.mode));
    const auto mesh = decode(view_bytes(file, it->second.Get("bufferView").GetNumberAsInt()), where);
    DracoPrimitive out;
    out.points = mesh->num_points();
    read_attributes(file, primitive, it->second.Get("attributes"), *mesh, here, out);
    read_corners(*mesh, where, out);
    return out;
}

}  // namespace relumine
