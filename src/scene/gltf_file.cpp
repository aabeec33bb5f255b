// SPDX-License-Identifier: Apache-2.0
// Reads a glTF file and its buffers. TinyGLTF 2.7 reads beyond buffers for images, cuts integers to 32 bits
// and opens any path, so it gets no images, no buffers, no file access, and a document that holds nothing but
// checked values.
#include "scene/gltf_file.hpp"

#include <fmt/format.h>

#include "base/message.hpp"
#include "relumine/error.hpp"
#include "scene/gltf_document.hpp"
#include "scene/gltf_meshopt.hpp"
#include "scene/quote.hpp"

namespace relumine {
namespace {

using nlohmann::json;

/// Whether the buffer is there for readers without EXT_meshopt_compression alone.
bool is_fallback(const json& buffer) {
    const json::json_pointer flag{"/extensions/EXT_meshopt_compression/fallback"};
    return buffer.contains(flag) && buffer.at(flag).get<bool>();
}

/// The bytes of buffer `i`, cut to its byteLength.
std::span<const std::uint8_t> load_buffer(GltfFile& file, const json& buffer, std::size_t i) {
    const std::string place = fmt::format("buffers[{}]", i);
    std::span<const std::uint8_t> bytes;
    if (buffer.contains("uri")) {
        const auto& uri = buffer["uri"].get_ref<const std::string&>();
        file.loaded.push_back(file.files->read_uri(uri, file.where(place + ".uri")));
        bytes = file.loaded.back();
    } else if (i == 0 && file.container.binary) {
        bytes = *file.container.binary;
    } else if (is_fallback(buffer)) {
        return {};  // what its views hold is unpacked from another buffer
    } else {
        throw SceneError{expected_found(file.where(place + ".uri"), "a value", "nothing")};
    }
    const auto length = buffer["byteLength"].get<std::size_t>();
    if (length > bytes.size())
        throw SceneError{expected_found(file.where(place + ".byteLength"),
                                        fmt::format("at most {}, what the buffer holds", bytes.size()),
                                        fmt::format("{}", length))};
    return bytes.first(length);
}

void load_buffers(GltfFile& file, const json& buffers) {
    for (std::size_t i = 0; i < buffers.size(); ++i) file.buffers.push_back(load_buffer(file, buffers[i], i));
}

void load_images(GltfFile& file, const json& images) {
    for (std::size_t i = 0; i < images.size(); ++i) {
        tinygltf::Image image;
        image.name = images[i].value("name", "");
        image.uri = images[i].value("uri", "");
        image.bufferView = images[i].value("bufferView", -1);
        if (image.uri.empty() == (image.bufferView < 0))
            throw SceneError{expected_found(file.where(fmt::format("images[{}]", i)),
                                            "either uri or bufferView",
                                            image.uri.empty() ? "none of them" : "both")};
        file.model.images.push_back(std::move(image));
    }
}

void check_buffer_views(const GltfFile& file) {
    for (std::size_t i = 0; i < file.model.bufferViews.size(); ++i) {
        const auto& view = file.model.bufferViews[i];
        if (view.extensions.contains("EXT_meshopt_compression")) continue;
        const std::size_t size = file.buffers[to_size(view.buffer)].size();
        const std::string place = fmt::format("bufferViews[{}]", i);
        if (view.byteOffset > size)
            throw SceneError{expected_found(file.where(place + ".byteOffset"),
                                            fmt::format("at most {}", size),
                                            fmt::format("{}", view.byteOffset))};
        if (view.byteLength > size - view.byteOffset)
            throw SceneError{expected_found(file.where(place + ".byteLength"),
                                            fmt::format("at most {}", size - view.byteOffset),
                                            fmt::format("{}", view.byteLength))};
    }
}

/// TinyGLTF refuses indices without a buffer view, which those that Draco packs have no need of.
void drop_packed_indices(json& document) {
    if (!document.contains("meshes")) return;
    for (json& mesh : document["meshes"])
        for (json& primitive : mesh["primitives"])
            if (primitive.contains(json::json_pointer{"/extensions/KHR_draco_mesh_compression"}))
                primitive.erase("indices");
}

/// The message's first line.
std::string first_line(const std::string& text) { return quote(text.substr(0, text.find('\n'))); }

tinygltf::Model parse_model(const json& document, const std::string& path) {
    tinygltf::TinyGLTF parser;
    parser.SetFsCallbacks({nullptr, nullptr, nullptr, nullptr, nullptr});
    tinygltf::Model model;
    std::string error, warning;
    const std::string text = document.dump();
    const auto length = static_cast<unsigned>(text.size());
    if (!parser.LoadASCIIFromString(&model, &error, &warning, text.data(), length, "") || !error.empty())
        throw SceneError{expected_found(path, "a valid glTF document", first_line(error))};
    return model;
}

}  // namespace

GltfFile read_gltf_file(const std::string& path, const std::vector<std::string>& allowed_folders) {
    GltfFile file;
    file.path = path;
    file.files = std::make_unique<SceneFiles>(path, allowed_folders);
    file.container = read_gltf_container(path);
    json document = read_gltf_document(file.container.json, path, file.warnings);
    const json buffers = document.value("buffers", json::array());
    const json images = document.value("images", json::array());
    document.erase("buffers");
    document.erase("images");
    drop_packed_indices(document);
    file.model = parse_model(document, path);
    load_buffers(file, buffers);
    load_images(file, images);
    check_buffer_views(file);
    unpack_gltf_views(file);
    return file;
}

std::span<const std::uint8_t> view_bytes(const GltfFile& file, int buffer_view) {
    const auto& view = file.model.bufferViews[to_size(buffer_view)];
    if (const auto it = file.unpacked.find(buffer_view); it != file.unpacked.end()) return it->second;
    return file.buffers[to_size(view.buffer)].subspan(view.byteOffset, view.byteLength);
}

}  // namespace relumine
