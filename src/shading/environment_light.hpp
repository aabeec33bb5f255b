// SPDX-License-Identifier: Apache-2.0
// Light from infinity: looking up and importance-sampling a lat-long picture.
#pragma once

#include <vector>

#include "base/frame.hpp"
#include "scene/scene_data.hpp"

namespace relumine {

struct EnvironmentSample {
    WorldDir direction;
    float pdf = 0;  // per steradian
};

/// The environment with a sampling density over its texels' areas: proportional to what the texel shines over
/// `floor` (its interpolated mean). With a floor of 0 this is plain importance sampling; with the mean it is
/// MIS compensation [Karlik19], right only beside BSDF sampling. Only texels are drawn within which the
/// interpolated radiance may exceed `threshold`: wherever it does, the density is not 0 and in proportion.
class EnvironmentLight {
  public:
    EnvironmentLight(const Environment& environment, float floor, float threshold = 0);

    /// Mean over the sphere of the channels' mean, W·sr⁻¹·m⁻².
    [[nodiscard]] static float mean_radiance(const Environment& environment);

    [[nodiscard]] Spectrum radiance(WorldDir direction) const;
    /// Density of `sample`, per steradian; 0 everywhere where nothing rises above the floor.
    [[nodiscard]] float pdf(WorldDir direction) const;
    /// Only where `can_sample()`.
    [[nodiscard]] EnvironmentSample sample(Point2 u) const;
    [[nodiscard]] bool can_sample() const { return can_sample_; }

  private:
    struct TexelCoordinates {
        float x, y;  // continuous, texel (i, j) covers [i, i+1) × [j, j+1)
    };
    [[nodiscard]] TexelCoordinates coordinates(WorldDir direction) const;
    [[nodiscard]] std::size_t row(int y) const {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_);
    }

    const Environment& environment_;
    int width_, height_;
    std::vector<float> row_cdf_;     // height + 1
    std::vector<float> texel_cdf_;   // height rows of width + 1
    std::vector<float> density_;     // per texel, per steradian
    std::vector<float> row_cosine_;  // height + 1: cos θ at the rows' borders, from 1 to −1
    bool can_sample_ = false;
};

}  // namespace relumine
