// SPDX-License-Identifier: Apache-2.0
// The files that a pbrt scene refers to: contained in the scene's folder, and within limits.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "scene/pbrt_tokenizer.hpp"

namespace relumine {

/// Reads what a scene refers to by name; names are relative to the folder of the scene itself, or else to
/// that of the file that names them. Throws SceneError.
class PbrtFiles {
  public:
    explicit PbrtFiles(const std::string& scene_path);

    /// The real path of the file, which lies in the scene's folder.
    [[nodiscard]] std::string resolve(const std::string& name, const PbrtPlace& place) const;
    /// The file's bytes, unpacked where it is packed with gzip.
    [[nodiscard]] std::vector<std::uint8_t> read(const std::string& name, const PbrtPlace& place);

  private:
    std::string folder_;
    std::size_t files_ = 0;
    std::size_t bytes_left_;
};

}  // namespace relumine
