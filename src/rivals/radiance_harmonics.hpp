// SPDX-License-Identifier: Apache-2.0
// Incident radiance as harmonics in the world's axes, and how it changes as the point moves [Krivanek05].
#pragma once

#include "rivals/harmonics.hpp"
#include "rivals/polar_hemisphere.hpp"

namespace relumine {

/// Coefficients of what one point sees: for `direct` and `indirect`, red, green and blue, the value and its
/// derivatives along the frame's s and t, 1/metre.
class RadianceHarmonics {
  public:
    static constexpr std::size_t quantities = 6, orders = 3;

    RadianceHarmonics() = default;
    explicit RadianceHarmonics(int bands)
        : stride_((harmonic_count(bands) + 7) / 8 * 8), values_(quantities * orders * stride_) {}

    [[nodiscard]] std::size_t stride() const { return stride_; }
    /// `order` 0: the value, 1: along s, 2: along t.
    [[nodiscard]] std::span<float> of(std::size_t quantity, std::size_t order) {
        return {&values_[(quantity * orders + order) * stride_], stride_};
    }
    [[nodiscard]] std::span<const float> of(std::size_t quantity, std::size_t order) const {
        return {&values_[(quantity * orders + order) * stride_], stride_};
    }
    [[nodiscard]] std::size_t bytes() const { return values_.size() * sizeof(float); }

  private:
    std::size_t stride_ = 0;
    std::vector<float> values_;
};

/// Of a hemisphere with Rings::even around `frame`. Light below the frame's horizon is none.
[[nodiscard]] RadianceHarmonics radiance_harmonics(const PolarHemisphere& hemisphere, const Frame& frame,
                                                   int bands);

}  // namespace relumine
