// SPDX-License-Identifier: Apache-2.0
// A map integral that stands for several camera samples.
#pragma once

#include "blocks/blend.hpp"
#include "integrators/lit_sample.hpp"

namespace relumine {

/// What a shared integral is to know beside itself.
struct IntegralNeeds {
    bool deviation = false;     // how wrong it may be
    bool distribution = false;  // of residual rays
};

/// The integral for one sample and for all that share it (`shares_integral`), with the density of their
/// residual rays. Holds what it needs to run again without allocating.
class SharedIntegral {
  public:
    SharedIntegral(const MapIntegral& integral, IntegralNeeds needs)
        : needs_(needs), integral_(integral), matte_(integral), distribution_(integral.grid()) {}

    /// For `first`, which must outlive this.
    void run(const LitSample& first, const Blend& blend);

    /// How many times more another pixel's blend of maps makes the samples reflect: so that weights change
    /// from pixel to pixel even if integrals do not.
    [[nodiscard]] float level_under(const Blend& other);

    /// Gives `sample` what the maps reflect at that level, its albedo and its deviation; returns how many
    /// times `integral()` its integral is at level 1: other than 1 for matte surfaces of another colour
    /// alone.
    Spectrum give(float level, LitSample& sample);

    [[nodiscard]] const LitSample& first() const { return *first_; }
    [[nodiscard]] const MapIntegral& integral() const { return integral_; }
    [[nodiscard]] const ResidualDistribution& distribution() const { return distribution_; }
    /// That integral() may be off by at the most, luminance.
    [[nodiscard]] float deviation() const { return deviation_; }

  private:
    void give_recoloured(Spectrum scale, LitSample& sample);
    [[nodiscard]] float reflected_under(const Blend& blend);

    IntegralNeeds needs_;
    const LitSample* first_ = nullptr;
    Blend blend_;
    MapIntegral integral_;
    MapIntegral matte_;  // of the diffuse part under layers, once it is needed
    bool has_matte_ = false;
    float deviation_ = 0;
    std::vector<std::pair<const BlockMap*, float>> reflected_of_;  // maps that were asked for
    ResidualDistribution distribution_;
};

}  // namespace relumine
