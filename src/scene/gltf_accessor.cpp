// SPDX-License-Identifier: Apache-2.0
// Typed arrays of a glTF file. gltf_schema.cpp bounds offsets (2^40), strides (252) and counts (2^31), so
// that none of the sums and products below can overflow 64 bits.
#include "scene/gltf_accessor.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <string_view>

#include "base/message.hpp"
#include "relumine/error.hpp"

namespace relumine {
namespace {

static_assert(std::endian::native == std::endian::little,
              "glTF buffers are little-endian and are read as they are");

constexpr int type_byte = TINYGLTF_COMPONENT_TYPE_BYTE, type_ubyte = TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE,
              type_short = TINYGLTF_COMPONENT_TYPE_SHORT,
              type_ushort = TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT,
              type_uint = TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT, type_float = TINYGLTF_COMPONENT_TYPE_FLOAT;

/// `count` elements of `components` values, the first at bytes[0]; all of them lie inside `bytes`.
struct Elements {
    std::span<const std::uint8_t> bytes;
    std::size_t count = 0, stride = 0;  // stride in bytes
    std::size_t components = 0, component_size = 0;
    int component_type = 0;
    bool normalized = false;

    [[nodiscard]] const std::uint8_t* component(std::size_t element, std::size_t i) const {
        return bytes.data() + element * stride + i * component_size;
    }
};

std::size_t component_bytes(const GltfFile& file, const std::string& place, int type) {
    switch (type) {
        case type_byte:
        case type_ubyte:
            return 1;
        case type_short:
        case type_ushort:
            return 2;
        case type_uint:
        case type_float:
            return 4;
        default:
            throw SceneError{expected_found(file.where(place + ".componentType"),
                                            "5120, 5121, 5122, 5123, 5125 or 5126", fmt::format("{}", type))};
    }
}

/// Places `elements` at `offset` of a buffer view; `stride` 0 means tightly packed.
void place_in_view(Elements& elements, const GltfFile& file, int view, std::size_t offset, std::size_t stride,
                   const std::string& place) {
    const auto bytes = view_bytes(file, view);
    const std::size_t element_size = elements.components * elements.component_size;
    elements.stride = stride == 0 ? element_size : stride;
    if (offset > bytes.size())
        throw SceneError{expected_found(file.where(place + ".byteOffset"),
                                        fmt::format("at most {}", bytes.size()), fmt::format("{}", offset))};
    const std::size_t needed = (elements.count - 1) * elements.stride + element_size;
    if (needed > bytes.size() - offset)
        throw SceneError{expected_found(
            file.where(place),
            fmt::format("at most {} bytes, the rest of bufferViews[{}]", bytes.size() - offset, view),
            fmt::format("{} elements that need {}", elements.count, needed))};
    elements.bytes = bytes.subspan(offset);
}

std::string accessor_place(int accessor) { return fmt::format("accessors[{}]", accessor); }

/// The dense part; `bytes` is empty where the accessor has no buffer view, which means zeros.
Elements dense_elements(const GltfFile& file, int accessor) {
    const auto& a = file.model.accessors[to_size(accessor)];
    const std::string place = accessor_place(accessor);
    Elements elements;
    elements.count = a.count;
    elements.components = to_size(component_count(file, accessor));
    elements.component_type = a.componentType;
    elements.component_size = component_bytes(file, place, a.componentType);
    elements.normalized = a.normalized;
    if (a.bufferView >= 0)
        place_in_view(elements, file, a.bufferView, a.byteOffset,
                      file.model.bufferViews[to_size(a.bufferView)].byteStride, place);
    return elements;
}

template <typename T>
T load(const std::uint8_t* bytes) {  // unaligned is fine
    T value;
    std::memcpy(&value, bytes, sizeof value);
    return value;
}

float as_float(const std::uint8_t* bytes, int type, bool normalized) {
    const auto scaled = [&](auto value, float unit) {
        const auto x = static_cast<float>(value);
        return normalized ? std::max(x / unit, -1.0f) : x;
    };
    switch (type) {
        case type_byte:
            return scaled(load<std::int8_t>(bytes), 127);
        case type_ubyte:
            return scaled(load<std::uint8_t>(bytes), 255);
        case type_short:
            return scaled(load<std::int16_t>(bytes), 32767);
        case type_ushort:
            return scaled(load<std::uint16_t>(bytes), 65535);
        case type_uint:
            return scaled(load<std::uint32_t>(bytes), 4294967295.0f);
        default:
            return load<float>(bytes);
    }
}

std::uint32_t as_index(const std::uint8_t* bytes, int type) {
    if (type == type_ubyte) return *bytes;
    if (type == type_ushort) return load<std::uint16_t>(bytes);
    return load<std::uint32_t>(bytes);
}

void check_index_type(const GltfFile& file, const std::string& place, int type) {
    if (type != type_ubyte && type != type_ushort && type != type_uint)
        throw SceneError{expected_found(file.where(place + ".componentType"),
                                        "5121, 5123 or 5125 for indices", fmt::format("{}", type))};
}

/// Where each replaced element goes: ascending, below the accessor's count.
std::vector<std::uint32_t> sparse_targets(const GltfFile& file, const tinygltf::Accessor& a,
                                          const std::string& place) {
    const auto& sparse = a.sparse;
    check_index_type(file, place + ".indices", sparse.indices.componentType);
    Elements elements;
    elements.count = to_size(sparse.count);
    elements.components = 1;
    elements.component_size = component_bytes(file, place + ".indices", sparse.indices.componentType);
    place_in_view(elements, file, sparse.indices.bufferView, to_size(sparse.indices.byteOffset), 0,
                  place + ".indices");
    std::vector<std::uint32_t> targets(elements.count);
    for (std::size_t i = 0; i < targets.size(); ++i) {
        targets[i] = as_index(elements.component(i, 0), sparse.indices.componentType);
        if (targets[i] >= a.count)
            throw SceneError{expected_found(file.where(fmt::format("{}.indices: element {}", place, i)),
                                            fmt::format("an index below {}", a.count),
                                            fmt::format("{}", targets[i]))};
    }
    return targets;
}

/// Copies elements of any source to `out`, element `i` to `target(i)`.
template <typename T, typename Convert, typename Target>
void copy_elements(const Elements& elements, std::vector<T>& out, const Convert& convert,
                   const Target& target) {
    for (std::size_t i = 0; i < elements.count; ++i)
        for (std::size_t c = 0; c < elements.components; ++c)
            out[target(i) * elements.components + c] = convert(elements.component(i, c));
}

template <typename T, typename Convert>
std::vector<T> read_elements(const GltfFile& file, int accessor, const Convert& convert) {
    Elements elements = dense_elements(file, accessor);
    std::vector<T> out(elements.count * elements.components);
    if (!elements.bytes.empty()) copy_elements(elements, out, convert, [](std::size_t i) { return i; });
    const auto& a = file.model.accessors[to_size(accessor)];
    if (!a.sparse.isSparse) return out;
    const std::string place = accessor_place(accessor) + ".sparse";
    const auto targets = sparse_targets(file, a, place);
    elements.count = targets.size();
    place_in_view(elements, file, a.sparse.values.bufferView, to_size(a.sparse.values.byteOffset), 0,
                  place + ".values");
    copy_elements(elements, out, convert, [&](std::size_t i) { return std::size_t{targets[i]}; });
    return out;
}

void check_components(const GltfFile& file, int accessor, int components) {
    if (component_count(file, accessor) == components) return;
    const auto name = [](int n) {
        return n == 0 ? std::string{"a matrix"} : n == 1 ? "SCALAR" : fmt::format("VEC{}", n);
    };
    throw SceneError{expected_found(file.where(accessor_place(accessor) + ".type"), name(components),
                                    name(component_count(file, accessor)))};
}

}  // namespace

int component_count(const GltfFile& file, int accessor) {
    switch (file.model.accessors[to_size(accessor)].type) {
        case TINYGLTF_TYPE_SCALAR:
            return 1;
        case TINYGLTF_TYPE_VEC2:
            return 2;
        case TINYGLTF_TYPE_VEC3:
            return 3;
        case TINYGLTF_TYPE_VEC4:
            return 4;
        default:
            return 0;
    }
}

std::vector<float> read_floats(const GltfFile& file, int accessor, int components) {
    check_components(file, accessor, components);
    const auto& a = file.model.accessors[to_size(accessor)];
    return read_elements<float>(file, accessor, [&](const std::uint8_t* bytes) {
        return as_float(bytes, a.componentType, a.normalized);
    });
}

std::vector<std::uint32_t> read_indices(const GltfFile& file, int accessor) {
    check_components(file, accessor, 1);
    const int type = file.model.accessors[to_size(accessor)].componentType;
    check_index_type(file, accessor_place(accessor), type);
    return read_elements<std::uint32_t>(file, accessor,
                                        [&](const std::uint8_t* bytes) { return as_index(bytes, type); });
}

}  // namespace relumine
