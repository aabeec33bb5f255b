// SPDX-License-Identifier: Apache-2.0
// The outer shell of a glTF file.
#include "scene/gltf_container.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "base/file.hpp"
#include "base/message.hpp"
#include "relumine/error.hpp"

namespace relumine {
namespace {

constexpr std::uint32_t json_chunk = 0x4e4f534a, binary_chunk = 0x004e4942;  // "JSON", "BIN\0"
constexpr std::size_t header_size = 12, chunk_header_size = 8;               // bytes

[[noreturn]] void refuse(const std::string& where, const std::string& expected, const std::string& found) {
    throw SceneError{expected_found(where, expected, found)};
}

/// Little-endian; the caller has checked that four bytes are there.
std::uint32_t u32(std::span<const std::uint8_t> bytes, std::size_t at) {
    return bytes[at] | std::uint32_t{bytes[at + 1]} << 8 | std::uint32_t{bytes[at + 2]} << 16
           | std::uint32_t{bytes[at + 3]} << 24;
}

bool is_glb(std::span<const std::uint8_t> bytes) {
    constexpr std::string_view magic = "glTF";
    return bytes.size() >= magic.size() && std::equal(magic.begin(), magic.end(), bytes.begin());
}

/// The bytes that the header speaks for.
std::span<const std::uint8_t> checked_glb(std::span<const std::uint8_t> bytes, const std::string& path) {
    if (bytes.size() < header_size + chunk_header_size)
        refuse(path, "a GLB header and a chunk of 20 bytes or more", fmt::format("{} bytes", bytes.size()));
    if (u32(bytes, 4) != 2) refuse(path, "GLB version 2", fmt::format("version {}", u32(bytes, 4)));
    const std::size_t length = u32(bytes, 8);
    if (length > bytes.size() || length < header_size + chunk_header_size)
        refuse(path + ": GLB length", fmt::format("20 to {} bytes, the size of the file", bytes.size()),
               fmt::format("{}", length));
    return bytes.first(length);
}

/// Reads one chunk at `at` and moves `at` behind it.
std::span<const std::uint8_t> read_chunk(std::span<const std::uint8_t> glb, std::size_t& at,
                                         std::size_t number, std::uint32_t& type, const std::string& path) {
    const std::string where = fmt::format("{}: GLB chunk {}", path, number);
    if (glb.size() - at < chunk_header_size)
        refuse(where, "a chunk header of 8 bytes", fmt::format("{} bytes", glb.size() - at));
    const std::size_t length = u32(glb, at);
    type = u32(glb, at + 4);
    at += chunk_header_size;
    if (length > glb.size() - at)
        refuse(where, fmt::format("at most {} bytes, the rest of the file", glb.size() - at),
               fmt::format("{}", length));
    const auto chunk = glb.subspan(at, length);
    at += std::min((length + 3) / 4 * 4, glb.size() - at);  // chunks are padded to four bytes
    return chunk;
}

void split_glb(GltfContainer& container, const std::string& path) {
    const auto glb = checked_glb(container.bytes, path);
    std::uint32_t type = 0;
    std::size_t at = header_size;
    container.json = read_chunk(glb, at, 0, type, path);
    if (type != json_chunk) refuse(path + ": GLB chunk 0", "JSON", fmt::format("type {:#010x}", type));
    for (std::size_t number = 1; at < glb.size(); ++number) {
        const auto chunk = read_chunk(glb, at, number, type, path);
        if (type == binary_chunk && !container.binary)
            container.binary = chunk;  // unknown chunks are to be skipped
    }
}

}  // namespace

GltfContainer read_gltf_container(const std::string& path) {
    GltfContainer container;
    container.bytes = read_file(path);
    if (container.bytes.empty()) refuse(path, "a glTF scene", "an empty file");
    if (is_glb(container.bytes))
        split_glb(container, path);
    else
        container.json = container.bytes;
    return container;
}

}  // namespace relumine
