// SPDX-License-Identifier: Apache-2.0
// Looking into the radiance cache: one pixel's way through it, step by step, in pictures and numbers.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "relumine/render.hpp"

namespace relumine {

/// What the cache did for one pixel; names and keys: docs/command.md, `relumine inspect`.
struct Inspection {
    /// In the order of the steps. One pixel per texel of a record, or per bit of the receiver's square; u to
    /// the right, v downwards. Metadata "unit": "radiance" (linear), else the picture is one of colours;
    /// "scale": the value that is shown as 1.
    std::vector<std::pair<std::string, Image>> pictures;
    std::string report_json;
};

/// Follows sample 0 of pixel (x, y) of the full frame through method `reproject`: its estimate has the bits
/// that `render` gives this pixel with the same settings and one sample. `settings.method`, `crop` and `aovs`
/// are not looked at. Throws SettingsError for bad settings and a pixel outside the frame, Error where the
/// pixel sees no surface or one that is not lit from records.
[[nodiscard]] Inspection inspect(const Scene& scene, const RenderSettings& settings, int x, int y);

}  // namespace relumine
