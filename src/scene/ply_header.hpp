// SPDX-License-Identifier: Apache-2.0
// The header of a PLY file: which elements and properties follow, and how they are encoded.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace relumine {

enum class PlyFormat { ascii, little_endian, big_endian };
enum class PlyType { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

struct PlyProperty {
    std::string name;
    PlyType type{};
    bool list = false;
    PlyType count_type{};  // of a list's length; an integer type
};

struct PlyElement {
    std::string name;
    std::uint64_t count = 0;  // as the file claims
    std::vector<PlyProperty> properties;
};

struct PlyHeader {
    PlyFormat format{};
    std::vector<PlyElement> elements;  // in file order
    std::size_t body = 0;              // offset of the first byte behind the header
};

/// Throws SceneError with the line.
[[nodiscard]] PlyHeader parse_ply_header(std::span<const std::uint8_t> bytes, const std::string& path);

/// Bytes of a binary value.
[[nodiscard]] std::size_t ply_type_size(PlyType type);

}  // namespace relumine
