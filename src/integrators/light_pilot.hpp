// SPDX-License-Identifier: Apache-2.0
// What the first rays of the pixels around tell of a pixel, before it spends more.
#pragma once

#include <span>
#include <vector>

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

/// What the first residual rays of a pixel's samples have found together, of what the filter smooths.
struct PilotResidual {
    float samples = 0;
    float rays = 0;  // that the samples got on average, together
    RayNoise noise;
    float deviation = 0;             // that was expected of one ray; a sum as that of `noise`
    const Material* seen = nullptr;  // by the first sample

    void add(const FoundResidual& found, float expected_of_one, const ShadingPoint& point);
};

/// How many times more than was expected single rays scatter in a cell: by surface, from all its pixels but
/// one's own, since few rays find little of what is rare, and that where it is not looked for.
class ResidualScatter {
  public:
    explicit ResidualScatter(std::span<const PilotResidual> cell);
    /// 1 where nothing is known.
    [[nodiscard]] float without(const PilotResidual& own) const;

  private:
    struct Sums {
        const Material* seen;
        double found = 0, expected = 0;  // variances of one ray, times rays

        void add(const PilotResidual& pilot, double sign);
    };
    std::vector<Sums> by_surface_;
};

}  // namespace relumine
