// SPDX-License-Identifier: Apache-2.0
// The JSON of a glTF file: parsed with limits, its version and extensions checked, reduced to what we read.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

namespace relumine {

/// Parses and checks the JSON. What is supported only in part is added to `warnings`. Throws SceneError.
[[nodiscard]] nlohmann::json read_gltf_document(std::span<const std::uint8_t> text, const std::string& file,
                                                std::vector<std::string>& warnings);

}  // namespace relumine
