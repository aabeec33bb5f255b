// SPDX-License-Identifier: Apache-2.0
// Which elements of a radiance field are worth being sampled like lamps.
#pragma once

#include <span>

#include "radiance/bright_cones.hpp"
#include "radiance/field_links.hpp"

namespace relumine {

struct BrightSurfaces {
    BrightCones cones;        // around those elements; empty if there are none
    float mean_radiance = 0;  // of all that is reflected, over the elements' area; luminance, W·sr⁻¹·m⁻²
};

/// Marks the few elements that reflect much more than others, if together they reflect much, and from so
/// small an area that rays over all directions miss it by chance. `irradiance`: by element. `distance`: to
/// what is seen, metres, in the middle.
[[nodiscard]] BrightSurfaces find_bright(FieldCells& cells, const FieldLinks& links,
                                         std::span<const Spectrum> irradiance, double distance);

}  // namespace relumine
