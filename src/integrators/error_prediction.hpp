// SPDX-License-Identifier: Apache-2.0
// How wrong `cache` believes its pixels to be.
#pragma once

#include <span>

#include "base/tile.hpp"
#include "integrators/ray_noise.hpp"
#include "integrators/residual_filter.hpp"
#include "integrators/residual_rays.hpp"

namespace relumine {

/// What is known of the error of a pixel's sum over its samples; luminance.
struct PixelDoubt {
    NoiseEstimate residual, bright;  // of what rays have found
    float albedo = 0;                // that this is divided by under the filter
    float deviation = 0;             // ΣMapIntegral::deviation(): what maps may be wrong by
    float unfiltered_variance =
        0;  // of what the samples differ by, of sharp lobes and of lamps in glossy ones
};

/// Gathers that, sample by sample.
class DoubtSum {
  public:
    /// `found`, `lobes`: by rays for what the maps hold, and for sharp lobes; `light`: all of the sample's
    /// but these, times `throughput`; `deviation`: of its integral.
    void add(const SampledRadiance& found, const SampledRadiance& lobes, Spectrum throughput, Spectrum light,
             Spectrum albedo, float deviation);
    [[nodiscard]] PixelDoubt finish() const;

  private:
    RayNoise residual_, cone_, light_, hit_, lobe_, mirrored_light_, mirrored_hit_;
    float albedo_ = 0, deviation_ = 0;
    float samples_ = 0, sum_ = 0, squares_ = 0;
};

/// One sigma of what maps are still wrong by after the filter.
[[nodiscard]] float deviation_left(const PixelDoubt& doubt);

/// The variances of what rays have found in pixels, over the squares of their `albedo`, from the pixels
/// around them on the same surface: few rays alone do not know how much they scatter. Row-major, as `guides`
/// (a picture without values).
[[nodiscard]] NoiseVariances noise_variances(const FilterImage& guides, std::span<const PixelDoubt> doubts,
                                             NoiseEstimate PixelDoubt::*kind, int threads);

}  // namespace relumine
