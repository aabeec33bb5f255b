// SPDX-License-Identifier: Apache-2.0
// Typed arrays of a glTF file: every component type, stride and sparse replacement, as floats or indices.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "scene/gltf_file.hpp"

namespace relumine {

/// How many components an element of the accessor has: 1 for SCALAR … 4 for VEC4, 0 for matrices.
[[nodiscard]] int component_count(const GltfFile& file, int accessor);

/// `components` floats per element, one element after the other; normalised integers are scaled. Throws
/// SceneError when the accessor has another number of components or leaves its buffer view.
[[nodiscard]] std::vector<float> read_floats(const GltfFile& file, int accessor, int components);

/// A scalar accessor of unsigned integers. Throws SceneError.
[[nodiscard]] std::vector<std::uint32_t> read_indices(const GltfFile& file, int accessor);

}  // namespace relumine
