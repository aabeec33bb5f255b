// SPDX-License-Identifier: Apache-2.0
// The smallest glTF worth rendering, made so that a test can spoil one thing of it in one line.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace relumine::test {

/// A white square that fills the view of its camera "main", emits 1 W·sr⁻¹·m⁻² and stands at z = −2. Its
/// buffer, embedded, holds four positions (48 bytes) and six 16-bit indices (12 bytes).
[[nodiscard]] nlohmann::json tiny_gltf();

/// The numbers in that buffer.
struct TinyGeometry {
    std::vector<float> positions{-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0};  // x, y, z
    std::vector<std::uint16_t> indices{0, 1, 2, 0, 2, 3};
};
void set_geometry(nlohmann::json& gltf, const TinyGeometry& geometry);

/// "data:…;base64,…".
[[nodiscard]] std::string data_uri(const std::string& bytes);

/// The document in a GLB without a binary chunk.
[[nodiscard]] std::string glb_of(const nlohmann::json& gltf);

/// A picture of 2 × 1 RGB texels, little-endian.
[[nodiscard]] std::string pfm_of(const std::vector<float>& rgb_rgb);

}  // namespace relumine::test
