// SPDX-License-Identifier: Apache-2.0
// EXT_meshopt_compression: buffer views that meshoptimizer unpacks.
#pragma once

#include "scene/gltf_file.hpp"

namespace relumine {

/// Unpacks every compressed buffer view into `file.unpacked`. The size of what is unpacked is checked against
/// that of the packed bytes before memory is taken. Throws SceneError.
void unpack_gltf_views(GltfFile& file);

}  // namespace relumine
