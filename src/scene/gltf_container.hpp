// SPDX-License-Identifier: Apache-2.0
// The outer shell of a glTF file: plain JSON, or a GLB with a JSON chunk and a binary chunk.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace relumine {

/// The spans point into `bytes`; a move keeps them valid, a copy would not.
struct GltfContainer {
    std::vector<std::uint8_t> bytes;  // the whole file
    std::span<const std::uint8_t> json;
    std::optional<std::span<const std::uint8_t>> binary;  // the BIN chunk of a GLB

    GltfContainer() = default;
    GltfContainer(GltfContainer&&) = default;
    GltfContainer& operator=(GltfContainer&&) = default;
};

/// Tells GLB from JSON by content and checks every chunk against the file's size. Throws SceneError or
/// FileError.
[[nodiscard]] GltfContainer read_gltf_container(const std::string& path);

}  // namespace relumine
