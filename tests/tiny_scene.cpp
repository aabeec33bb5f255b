// SPDX-License-Identifier: Apache-2.0
// The smallest glTF worth rendering.
#include "tiny_scene.hpp"

#include <cstring>
#include <string_view>

namespace relumine::test {
namespace {

using nlohmann::json;

template <typename Number>
std::string bytes_of(const std::vector<Number>& numbers) {
    std::string bytes(numbers.size() * sizeof(Number), '\0');
    std::memcpy(bytes.data(), numbers.data(),
                bytes.size());  // little-endian, as every machine that we build for
    return bytes;
}

std::string base64(const std::string& bytes) {
    constexpr std::string_view alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        std::uint32_t bits = 0;
        for (std::size_t k = 0; k < 3; ++k)
            bits = bits << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
        for (std::size_t k = 0; k < 4; ++k)
            text += i + k <= bytes.size() ? alphabet[bits >> (18 - 6 * k) & 63] : '=';
    }
    return text;
}

}  // namespace

json tiny_gltf() {
    json gltf = json::parse(R"({
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0, 1]}],
        "nodes": [{"mesh": 0, "translation": [0, 0, -2]}, {"camera": 0}],
        "cameras": [{"name": "main", "type": "perspective", "perspective": {"yfov": 0.8, "aspectRatio": 1, "znear": 0.1}}],
        "materials": [{"emissiveFactor": [1, 1, 1], "pbrMetallicRoughness": {"metallicFactor": 0}}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 0}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [-1, -1, 0], "max": [1, 1, 0]},
            {"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"}],
        "bufferViews": [
            {"buffer": 0, "byteOffset": 0, "byteLength": 48},
            {"buffer": 0, "byteOffset": 48, "byteLength": 12}]
    })");
    set_geometry(gltf, {});
    return gltf;
}

void set_geometry(json& gltf, const TinyGeometry& geometry) {
    const std::string bytes = bytes_of(geometry.positions) + bytes_of(geometry.indices);
    gltf["buffers"] = json::array({{{"byteLength", bytes.size()}, {"uri", data_uri(bytes)}}});
}

std::string data_uri(const std::string& bytes) {
    return "data:application/octet-stream;base64," + base64(bytes);
}

std::string glb_of(const json& gltf) {
    std::string text = gltf.dump();
    text.resize((text.size() + 3) / 4 * 4, ' ');
    const auto size = static_cast<std::uint32_t>(text.size());
    return "glTF" + bytes_of<std::uint32_t>({2, 20 + size, size}) + "JSON" + text;
}

std::string pfm_of(const std::vector<float>& rgb_rgb) { return "PF\n2 1\n-1.0\n" + bytes_of(rgb_rgb); }

}  // namespace relumine::test
