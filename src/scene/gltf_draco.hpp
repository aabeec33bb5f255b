// SPDX-License-Identifier: Apache-2.0
// KHR_draco_mesh_compression: primitives that Draco unpacks.
#pragma once

#include <optional>

#include "scene/gltf_file.hpp"

namespace relumine {

/// A primitive as Draco holds it.
struct DracoPrimitive {
    struct Attribute {
        int components = 0;
        std::vector<float> values;  // normalised where the accessor says so
    };
    std::size_t points = 0;
    std::map<std::string, Attribute> attributes;  // by their names in glTF
    std::vector<std::uint32_t> corners;           // three per triangle
};

/// Empty where the primitive is not compressed. The sizes that the packed data claim are checked against
/// their length before Draco sees them. `place`: of the primitive, for messages. Throws SceneError.
[[nodiscard]] std::optional<DracoPrimitive> unpack_gltf_primitive(const GltfFile& file,
                                                                  const tinygltf::Primitive& primitive,
                                                                  const std::string& place);

}  // namespace relumine
