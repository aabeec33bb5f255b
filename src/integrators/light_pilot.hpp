// SPDX-License-Identifier: Apache-2.0
// What the first light samples of the pixels around tell of a pixel, before it spends more.
#pragma once

#include <span>

#include "integrators/residual_rays.hpp"

namespace relumine {

/// Of a pixel's samples together; luminance.
struct PilotLight {
    float samples = 0;  // of the camera, that were lit
    float sum = 0;      // that reached them
    RayNoise noise;     // of that sum

    void add(const FoundLight& found, float throughput);
};

/// What a camera sample at (x, y) may expect, from the pixels around in a cell of `width` pixels a row:
/// without its own, so that a decision by it leaves an average unbiased.
struct ExpectedLight {
    float mean = 0, deviation = 0;
    bool known = false;
};
[[nodiscard]] ExpectedLight expected_light(std::span<const PilotLight> cell, int width, int x, int y);

}  // namespace relumine
