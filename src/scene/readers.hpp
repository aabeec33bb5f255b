// SPDX-License-Identifier: Apache-2.0
// One reader per format: a file becomes an unfinished SceneData.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "relumine/scene.hpp"
#include "scene/scene_data.hpp"

namespace relumine {

/// glTF 2.0, `.gltf` or `.glb`. Files that it refers to lie in its folder or where `options` allow; its
/// textures are halved to fit their limit. Throws SceneError or ImageError.
[[nodiscard]] SceneData read_gltf(const std::string& path, const SceneOptions& options = {});

/// A mesh alone, without material, camera or light; polygons are cut into triangles. The file may be packed
/// with gzip. What was left out is added to `warnings`. Throws SceneError or FileError.
[[nodiscard]] Mesh read_ply(const std::string& path, std::vector<std::string>& warnings);
[[nodiscard]] Mesh read_obj(const std::string& path, std::vector<std::string>& warnings);

/// The mesh in the bytes of an unpacked PLY file; `path` begins every message.
[[nodiscard]] Mesh parse_ply(std::span<const std::uint8_t> bytes, const std::string& path,
                             std::vector<std::string>& warnings);

/// pbrt-v4's scene description, `.pbrt`, with all that it includes; files as for glTF. Throws SceneError or
/// ImageError.
[[nodiscard]] SceneData read_pbrt(const std::string& path, const SceneOptions& options = {});

/// Mitsuba's scene description, `.xml` of version 2 or 3, with all that it includes; files as for glTF. The
/// options' definitions go before the defaults of its parameters. Throws SceneError or ImageError.
[[nodiscard]] SceneData read_mitsuba(const std::string& path, const SceneOptions& options = {});

/// Lat-long `.exr`, `.hdr`, `.pfm`. Negative or non-finite texels become 0 and are counted in a warning.
/// Throws ImageError.
[[nodiscard]] Environment read_environment(const std::string& path, std::vector<std::string>& warnings);

}  // namespace relumine
