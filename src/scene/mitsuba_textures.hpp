// SPDX-License-Identifier: Apache-2.0
// Mitsuba's textures as graphs that are baked into images.
#pragma once

#include <map>

#include "scene/mitsuba_spectrum.hpp"
#include "scene/pbrt_textures.hpp"

namespace relumine {

class MitsubaTextures {
  public:
    MitsubaTextures(MitsubaScene& scene, SceneData& out)
        : scene_(scene), baker_(scene.notes, scene.files, out) {}

    /// The colour or texture `name` of an object; `otherwise` where it is not given.
    [[nodiscard]] PbrtNodeRef color(MitsubaProperties& p, std::string_view name, Spectrum otherwise,
                                    MitsubaColorUse use = MitsubaColorUse::albedo);
    /// A number or texture; of textures the luminance counts.
    [[nodiscard]] PbrtNodeRef number(MitsubaProperties& p, std::string_view name, double otherwise);
    /// A <texture>, or a colour.
    [[nodiscard]] PbrtNodeRef node(const MitsubaElement& element, MitsubaColorUse use);
    [[nodiscard]] PbrtTextures& baker() { return baker_; }

  private:
    [[nodiscard]] PbrtNodeRef bitmap(MitsubaProperties& p);
    [[nodiscard]] PbrtNodeRef checkerboard(MitsubaProperties& p, MitsubaColorUse use);
    [[nodiscard]] PbrtNodeRef scale(MitsubaProperties& p, MitsubaColorUse use);

    MitsubaScene& scene_;
    PbrtTextures baker_;
    std::map<std::pair<const MitsubaElement*, MitsubaColorUse>, PbrtNodeRef> made_;
    int depth_ = 0;
};

}  // namespace relumine
