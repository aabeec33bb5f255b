// SPDX-License-Identifier: Apache-2.0
// What rays have found in the pixels of a pass of `cache`: filtered, added, and judged.
#pragma once

#include <span>
#include <vector>

#include "base/tile.hpp"
#include "integrators/error_prediction.hpp"
#include "integrators/residual_filter.hpp"

namespace relumine {

/// What the filter needs of a pixel beside its guide; sums over its samples.
struct PixelResidual {
    Spectrum direct, indirect;  // dim
    Spectrum bright;
    Spectrum albedo;  // directional, times the throughput of what is before
};

class ResidualFilm {
  public:
    /// `filters`: what is put goes through the filter; `predicts`: errors are wanted.
    ResidualFilm(bool filters, bool predicts) : filters_(filters), predicts_(predicts) {}

    /// Whether pixels must know their surroundings.
    [[nodiscard]] bool estimates_noise() const { return filters_ || predicts_; }
    /// How far away these are, pixels.
    [[nodiscard]] int reach() const;
    [[nodiscard]] std::size_t bytes_per_pixel() const;

    /// Begins a pass of so many pixels: nothing has been found.
    void begin(int width, int height);
    /// What a pixel's rays have found (not read without the filter), and how far it may be trusted. Pixels at
    /// once, each once. Only if it estimates noise.
    void put(std::size_t pixel, const PixelResidual& residual, const PixelDoubt& doubt,
             const FilterGuide& guide);

    /// Adds what was found, filtered, to `pixels`, and what they are expected to be wrong by. `exact`: maps
    /// do not err; `bright`: there is bright light.
    void add_to(std::span<PixelSums> pixels, bool exact, bool bright, int threads);

  private:
    struct Part {
        Spectrum PixelResidual::*found;
        Spectrum SplitRadiance::*light;
    };
    void add_kind(std::span<PixelSums> pixels, NoiseEstimate PixelDoubt::*kind,
                  const std::vector<Part>& parts, int threads);
    void add_part(std::span<PixelSums> pixels, const Part& part, const std::vector<Spectrum>& values) const;

    bool filters_, predicts_;
    std::vector<PixelResidual> residuals_;
    std::vector<PixelDoubt> doubts_;
    FilterImage guides_;  // without values
};

}  // namespace relumine
