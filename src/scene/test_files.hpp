// SPDX-License-Identifier: Apache-2.0
// For tests: files in a folder that vanishes, and glTF documents built piece by piece.
#pragma once

#include <unistd.h>

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace relumine::test {

/// A folder of its own for each test.
class TempFolder {
  public:
    TempFolder() {
        std::string name = (std::filesystem::temp_directory_path() / "relumine_scene_XXXXXX").string();
        path_ = ::mkdtemp(name.data());
    }
    ~TempFolder() { std::filesystem::remove_all(path_); }
    TempFolder(const TempFolder&) = delete;
    TempFolder& operator=(const TempFolder&) = delete;

    [[nodiscard]] std::string path(const std::string& name) const { return (path_ / name).string(); }
    std::string write(const std::string& name, std::string_view bytes) const {
        std::filesystem::create_directories((path_ / name).parent_path());
        std::ofstream{path(name), std::ios::binary}.write(bytes.data(),
                                                          static_cast<std::streamsize>(bytes.size()));
        return path(name);
    }

  private:
    std::filesystem::path path_;
};

inline std::string base64(std::string_view bytes) {
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

template <typename T>
std::string bytes_of(const std::vector<T>& values) {
    std::string bytes(values.size() * sizeof(T), '\0');
    if (!values.empty()) std::memcpy(bytes.data(), values.data(), bytes.size());
    return bytes;
}

/// A glTF document and the bytes of its only buffer. Tests change `document` as they like before they write
/// it.
struct GltfBuilder {
    nlohmann::json document = {{"asset", {{"version", "2.0"}}}};
    std::string binary;

    std::size_t add(const char* array, nlohmann::json element) {
        document[array].push_back(std::move(element));
        return document[array].size() - 1;
    }
    std::size_t add_view(std::string_view bytes) {
        binary.resize((binary.size() + 3) / 4 * 4);
        const std::size_t offset = binary.size();
        binary += bytes;
        return add("bufferViews", {{"buffer", 0}, {"byteOffset", offset}, {"byteLength", bytes.size()}});
    }
    template <typename T>
    std::size_t add_accessor(const std::vector<T>& values, int component_type, const char* type,
                             std::size_t components) {
        return add("accessors", {{"bufferView", add_view(bytes_of(values))},
                                 {"componentType", component_type},
                                 {"count", values.size() / components},
                                 {"type", type}});
    }
    std::size_t add_vec2(const std::vector<float>& values) { return add_accessor(values, 5126, "VEC2", 2); }
    std::size_t add_vec3(const std::vector<float>& values) { return add_accessor(values, 5126, "VEC3", 3); }
    std::size_t add_vec4(const std::vector<float>& values) { return add_accessor(values, 5126, "VEC4", 4); }
    std::size_t add_indices(const std::vector<std::uint16_t>& values) {
        return add_accessor(values, 5123, "SCALAR", 1);
    }

    /// The primitive that tests change.
    nlohmann::json& primitive() { return document["meshes"][0]["primitives"][0]; }
    nlohmann::json& attributes() { return primitive()["attributes"]; }

    [[nodiscard]] std::string json_text() const {
        nlohmann::json whole = document;
        if (!whole.contains("buffers"))
            whole["buffers"] = {{{"byteLength", binary.size()},
                                 {"uri", "data:application/octet-stream;base64," + base64(binary)}}};
        return whole.dump();
    }
    [[nodiscard]] std::string glb() const {
        nlohmann::json whole = document;
        whole["buffers"] = {{{"byteLength", binary.size()}}};
        std::string json = whole.dump(), data = binary;
        json.resize((json.size() + 3) / 4 * 4, ' ');
        data.resize((data.size() + 3) / 4 * 4);
        const auto u32 = [](std::size_t x) { return bytes_of(std::vector{static_cast<std::uint32_t>(x)}); };
        return "glTF" + u32(2) + u32(12 + 8 + json.size() + 8 + data.size()) + u32(json.size()) + "JSON"
               + json + u32(data.size()) + std::string{"BIN\0", 4} + data;
    }
};

/// One triangle in the plane z = 0, counter-clockwise from +Z: meshes[0] on nodes[0], indices in
/// accessors[1].
inline GltfBuilder triangle_document() {
    GltfBuilder builder;
    const std::size_t positions = builder.add_vec3({0, 0, 0, 1, 0, 0, 0, 1, 0});
    const std::size_t indices = builder.add_indices({0, 1, 2});
    builder.add("meshes",
                {{"name", "triangle"},
                 {"primitives", {{{"attributes", {{"POSITION", positions}}}, {"indices", indices}}}}});
    builder.add("nodes", {{"mesh", 0}});
    builder.add("scenes", {{"nodes", {0}}});
    builder.document["scene"] = 0;
    return builder;
}

/// A 1 × 1 opaque red PNG.
inline std::string red_png() {
    constexpr unsigned char bytes[] = {0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d,
                                       0x49, 0x48, 0x44, 0x52, 0x00, 0x00, 0x00, 0x01, 0x00, 0x00, 0x00, 0x01,
                                       0x08, 0x02, 0x00, 0x00, 0x00, 0x90, 0x77, 0x53, 0xde, 0x00, 0x00, 0x00,
                                       0x0c, 0x49, 0x44, 0x41, 0x54, 0x08, 0xd7, 0x63, 0xf8, 0xcf, 0xc0, 0x00,
                                       0x00, 0x03, 0x01, 0x01, 0x00, 0x18, 0xdd, 0x8d, 0xb0, 0x00, 0x00, 0x00,
                                       0x00, 0x49, 0x45, 0x4e, 0x44, 0xae, 0x42, 0x60, 0x82};
    return {reinterpret_cast<const char*>(bytes), sizeof bytes};
}

/// Adds an image from a buffer view, and a texture of it; returns the texture.
inline std::size_t add_texture(GltfBuilder& builder) {
    const std::size_t image =
        builder.add("images", {{"bufferView", builder.add_view(red_png())}, {"mimeType", "image/png"}});
    return builder.add("textures", {{"source", image}});
}

}  // namespace relumine::test
