// SPDX-License-Identifier: Apache-2.0
// The transforms of pbrt's directives.
#pragma once

#include <optional>

#include "base/transform.hpp"

namespace relumine {

using PbrtTriple = std::array<double, 3>;

[[nodiscard]] Transform pbrt_translate(PbrtTriple by);
[[nodiscard]] Transform pbrt_scale(PbrtTriple by);
/// Counter-clockwise by `degrees` about `axis` (any length but 0) in a right-handed reading of the
/// coordinates, clockwise in pbrt's left-handed one.
[[nodiscard]] Transform pbrt_rotate(double degrees, PbrtTriple axis);
/// camera_from_world: the camera at `eye` looks along +Z at `look`, with `up` upwards and +X to the right of
/// the picture. Empty where the three do not make a frame.
[[nodiscard]] std::optional<Transform> pbrt_look_at(PbrtTriple eye, PbrtTriple look, PbrtTriple up);

/// Empty for transforms that are flat or not finite.
[[nodiscard]] std::optional<Transform> inverse(const Transform& t);

}  // namespace relumine
