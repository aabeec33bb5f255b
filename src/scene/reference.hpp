// SPDX-License-Identifier: Apache-2.0
// What a scene file refers to by URI: data inside the URI, or a file that must lie in the scene's folder.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace relumine {

/// The bytes behind `uri`. `where` ("kitchen.gltf: buffers[0].uri") begins every message.
/// Throws SceneError for what leaves `folder` (absolute paths, "..", symbolic links), for networks and for
/// damage.
[[nodiscard]] std::vector<std::uint8_t> read_reference(const std::string& uri, const std::string& folder,
                                                       const std::string& where);

/// The real path of the file `name`, which must lie inside `folder`. Throws as above.
[[nodiscard]] std::string contained_path(const std::string& name, const std::string& folder,
                                         const std::string& where);

/// The folder that `path` lies in; "." where it names none.
[[nodiscard]] std::string folder_of(const std::string& path);

}  // namespace relumine
