// SPDX-License-Identifier: Apache-2.0
// A glTF file in memory: TinyGLTF's structures over a document that has been checked, and its buffers.
#pragma once

#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#define TINYGLTF_NO_INCLUDE_STB_IMAGE
#define TINYGLTF_NO_INCLUDE_STB_IMAGE_WRITE
#define TINYGLTF_NO_FS
#include <tiny_gltf.h>

#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "scene/gltf_container.hpp"
#include "scene/scene_files.hpp"

namespace relumine {

/// Every index between the parts of `model` is valid; every buffer view lies inside its buffer.
struct GltfFile {
    std::string path;  // for messages
    tinygltf::Model model;
    std::vector<std::span<const std::uint8_t>>
        buffers;  // of exactly `byteLength` bytes, into `container` or `loaded`
    GltfContainer container;
    std::vector<std::vector<std::uint8_t>> loaded;
    std::unique_ptr<SceneFiles> files;                  // for whatever has a URI
    std::map<int, std::vector<std::uint8_t>> unpacked;  // buffer views that were compressed
    std::vector<std::string> warnings;

    /// "kitchen.glb: place".
    [[nodiscard]] std::string where(const std::string& place) const { return path + ": " + place; }
};

/// Reads the file and all of its buffers; images stay encoded. Throws SceneError.
[[nodiscard]] GltfFile read_gltf_file(const std::string& path,
                                      const std::vector<std::string>& allowed_folders = {});

/// The bytes of a buffer view.
[[nodiscard]] std::span<const std::uint8_t> view_bytes(const GltfFile& file, int buffer_view);

/// An index or size as the standard library wants it; the value must not be negative.
constexpr std::size_t to_size(int index) { return static_cast<std::size_t>(index); }

}  // namespace relumine
