// SPDX-License-Identifier: Apache-2.0
// The files that a pbrt scene refers to, with pbrt's places in the messages.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "scene/pbrt_tokenizer.hpp"
#include "scene/scene_files.hpp"

namespace relumine {

/// Reads what a scene refers to by name; names are relative to the folder of the scene itself, or else to
/// that of the file that names them. Throws SceneError.
class PbrtFiles {
  public:
    explicit PbrtFiles(const std::string& scene_path, const std::vector<std::string>& allowed_folders = {})
        : files_(scene_path, allowed_folders) {}

    /// The real path of the file.
    [[nodiscard]] std::string resolve(const std::string& name, const PbrtPlace& place) const {
        return files_.resolve(name, place.text(), file_of(place));
    }
    /// The file's bytes, unpacked where it is packed with gzip.
    [[nodiscard]] std::vector<std::uint8_t> read(const std::string& name, const PbrtPlace& place) {
        return files_.read(name, place.text(), file_of(place));
    }

  private:
    [[nodiscard]] static std::string file_of(const PbrtPlace& place) {
        return place.file ? *place.file : std::string{};
    }

    SceneFiles files_;
};

}  // namespace relumine
