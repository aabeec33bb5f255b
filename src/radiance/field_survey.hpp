// SPDX-License-Identifier: Apache-2.0
// What is asked of a radiance field's element before its rays are traced: is it to be divided?
#pragma once

#include "radiance/field_rays.hpp"

namespace relumine {

/// What is known of an element before its rays are traced.
struct ElementSurvey {
    IrradianceVector light;     // that samples of the lights bring
    float contrast = 0;         // W·m⁻²: how far that differs between the points, over noise
    float distance = infinity;  // metres, the geometric mean of what is seen
};

/// Samples the lights from `points`, for an element of this normal, and looks how far other surfaces are.
[[nodiscard]] ElementSurvey survey_element(const Transport& t, Vec3 normal,
                                           std::span<const StartPoint> points, ElementId id,
                                           const FieldSettings& settings, RayCounts& rays);

}  // namespace relumine
