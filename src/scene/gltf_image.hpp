// SPDX-License-Identifier: Apache-2.0
// Images of a glTF file, decoded.
#pragma once

#include <vector>

#include "image/byte_image.hpp"
#include "scene/gltf_file.hpp"
#include "scene/texture_budget.hpp"

namespace relumine {

/// Decodes the file's images `which`, in that order, on all threads. Throws SceneError or ImageError.
[[nodiscard]] std::vector<ByteImage> decode_gltf_images(const GltfFile& file, const std::vector<int>& which,
                                                        TextureBudget& budget);

}  // namespace relumine
