// SPDX-License-Identifier: Apache-2.0
// What a scene file refers to by URI: data inside the URI, or a file that must lie in the scene's folder.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/file.hpp"

namespace relumine {

/// The bytes behind `uri`. `where` ("kitchen.gltf: buffers[0].uri") begins every message.
/// Throws SceneError for what leaves `folder` and every one of `allowed` (absolute paths, "..", symbolic
/// links), for networks, for damage, and for files of more than `limit` bytes.
[[nodiscard]] std::vector<std::uint8_t> read_reference(const std::string& uri, const std::string& folder,
                                                       const std::string& where,
                                                       const std::vector<std::string>& allowed = {},
                                                       std::size_t limit = default_file_limit);

/// The real path of the file `name`, which is relative to `folder` and must lie inside it or inside one of
/// `allowed`. Throws as above. The one rule of what a scene may open.
[[nodiscard]] std::string contained_path(const std::string& name, const std::string& folder,
                                         const std::string& where,
                                         const std::vector<std::string>& allowed = {});

/// The folder that `path` lies in; "." where it names none.
[[nodiscard]] std::string folder_of(const std::string& path);

}  // namespace relumine
