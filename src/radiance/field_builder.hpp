// SPDX-License-Identifier: Apache-2.0
// Building a radiance field.
#pragma once

#include "radiance/field_bright.hpp"
#include "radiance/radiance_field.hpp"

namespace relumine {

/// All that a radiance field keeps of its building.
struct BuiltField {
    FieldCells cells;
    BrightSurfaces bright;
    std::vector<ElementArrivals> arrivals;  // by element, where the settings want them
    NoisyLight noisy;
    float most_found;  // RadianceField::most_found()
    Reflections reflections;
    FieldFigures figures;
};

/// A function of scene, seeds and settings alone, whatever the number of threads.
[[nodiscard]] BuiltField build_field(const Transport& t, std::span<const FieldSeed> seeds,
                                     const FieldSettings& settings, RayCounts& rays);

}  // namespace relumine
