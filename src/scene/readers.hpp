// SPDX-License-Identifier: Apache-2.0
// One reader per format: a file becomes an unfinished SceneData.
#pragma once

#include <string>

#include "scene/scene_data.hpp"

namespace relumine {

/// glTF 2.0, `.gltf` or `.glb`. Throws SceneError or ImageError.
[[nodiscard]] SceneData read_gltf(const std::string& path);

/// A mesh alone, without material, camera or light; polygons are cut into triangles. The file may be packed
/// with gzip. What was left out is added to `warnings`. Throws SceneError or FileError.
[[nodiscard]] Mesh read_ply(const std::string& path, std::vector<std::string>& warnings);
[[nodiscard]] Mesh read_obj(const std::string& path, std::vector<std::string>& warnings);

/// Lat-long `.exr`, `.hdr`, `.pfm`. Negative or non-finite texels become 0 and are counted in a warning.
/// Throws ImageError.
[[nodiscard]] Environment read_environment(const std::string& path, std::vector<std::string>& warnings);

}  // namespace relumine
