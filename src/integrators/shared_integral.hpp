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

/// The integral for one sample and for all that share it (`shares_integral`), with the density of their residual
/// rays. Holds what it needs to run again without allocating.
class SharedIntegral {
  public:
    SharedIntegral(const MapIntegral& integral, IntegralNeeds needs)
        : needs_(needs), integral_(integral), matte_(integral), distribution_(integral.grid()) {}

    /// For `first`, which must outlive this.
    void run(const LitSample& first, const Blend& blend);

    /// Gives `sample` what the maps reflect, its albedo and its deviation; returns how many times `integral()`
    /// its integral is: other than 1 for matte surfaces of another colour alone.
    Spectrum give(LitSample& sample);

    [[nodiscard]] const LitSample& first() const { return *first_; }
    [[nodiscard]] const MapIntegral& integral() const { return integral_; }
    [[nodiscard]] const ResidualDistribution& distribution() const { return distribution_; }
    /// That integral() may be off by at the most, luminance.
    [[nodiscard]] float deviation() const { return deviation_; }

  private:
    void give_recoloured(Spectrum scale, LitSample& sample);

    IntegralNeeds needs_;
    const LitSample* first_ = nullptr;
    Blend blend_;
    MapIntegral integral_;
    MapIntegral matte_;  // of the diffuse part under layers, once it is needed
    bool has_matte_ = false;
    float deviation_ = 0;
    ResidualDistribution distribution_;
};

}  // namespace relumine
