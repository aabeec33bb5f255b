// SPDX-License-Identifier: Apache-2.0
// All reflections of light at once.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "base/vec.hpp"

namespace relumine {

/// By element: what arrives there, W·m⁻².
using LightByElement = std::vector<Spectrum>;

/// One reflection of `light` by all elements; linear.
using Reflect = std::function<void(std::span<const Spectrum> light, LightByElement& reflected)>;

/// Sum of the absolute values.
[[nodiscard]] double total(std::span<const Spectrum> light);

/// `arriving`, and all that becomes of it: (1 − K)⁻¹ arriving, where K is one reflection, until what is still
/// to be reflected is less than `least` in total. Stabilised biconjugate gradients [VanDerVorst92].
struct AllReflections {
    LightByElement light;
    std::size_t asked = 0;   // how often K was
    bool converged = false;  // else light is of no use
};
[[nodiscard]] AllReflections all_reflections(LightByElement arriving, double least, std::size_t most_asked,
                                             const Reflect& reflect);

}  // namespace relumine
