// SPDX-License-Identifier: Apache-2.0
// Mitsuba's shapes as triangle meshes.
#pragma once

#include <span>

#include "scene/mitsuba_properties.hpp"
#include "scene/pbrt_shapes.hpp"
#include "scene/scene_data.hpp"

namespace relumine {

struct MitsubaMesh {
    Mesh mesh;
    Transform object_from_mesh;  // what stands in front of the shape's own to_world
};

/// Throws SceneError or FileError. Faces outwards, or inwards with `flip_normals`; v grows downwards.
[[nodiscard]] MitsubaMesh make_mitsuba_mesh(MitsubaProperties& p, const PbrtDetail& detail);

/// Whether triangles only approximate it: a sphere, disk or cylinder.
[[nodiscard]] bool is_mitsuba_curved(const std::string& type);

/// Mesh `shape` of a `.serialized` file (versions 3 and 4). `where` begins every message.
[[nodiscard]] Mesh parse_serialized(std::span<const std::uint8_t> bytes, std::size_t shape,
                                    const std::string& where);

}  // namespace relumine
