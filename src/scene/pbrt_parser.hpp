// SPDX-License-Identifier: Apache-2.0
// From the text of pbrt files to what they say.
#pragma once

#include "scene/pbrt_files.hpp"
#include "scene/pbrt_scene.hpp"

namespace relumine {

/// Parses the file and all that it includes. Throws SceneError with the place of the first mistake.
[[nodiscard]] PbrtScene parse_pbrt(const std::string& path, PbrtFiles& files);

/// The same from memory; `name` stands in messages.
[[nodiscard]] PbrtScene parse_pbrt_text(std::string text, const std::string& name, PbrtFiles& files);

}  // namespace relumine
