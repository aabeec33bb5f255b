// SPDX-License-Identifier: Apache-2.0
// Mitsuba's colours and spectra reduced to linear Rec. 709 RGB.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/vec.hpp"
#include "scene/mitsuba_properties.hpp"

namespace relumine {

enum class MitsubaColorUse {
    albedo,     // clamped to [0, 1] (with a warning); a constant spectrum is grey
    unbounded,  // an index of refraction
    light,      // radiometric: a constant spectrum has the colour of illuminant E
};

/// Of <rgb>, <srgb>, <spectrum>, <blackbody> and <float>. Throws SceneError for other tags and bad values.
[[nodiscard]] Spectrum mitsuba_color(const MitsubaElement& element, MitsubaColorUse use, MitsubaScene& scene);

/// The colour `name` of an object, or `otherwise`.
[[nodiscard]] Spectrum mitsuba_color(MitsubaProperties& p, std::string_view name, Spectrum otherwise,
                                     MitsubaColorUse use);

/// Reflectance at normal incidence under D65 of Mitsuba's named metals (and other substances with a k).
[[nodiscard]] std::optional<Spectrum> mitsuba_metal(const std::string& name);
[[nodiscard]] std::vector<std::string> mitsuba_metal_names();

/// Index of refraction of Mitsuba's named dielectrics ("bk7"), or nothing.
[[nodiscard]] std::optional<double> mitsuba_ior(const std::string& name);
[[nodiscard]] std::vector<std::string> mitsuba_ior_names();

}  // namespace relumine
