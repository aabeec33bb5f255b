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
    /// Filtered at a time are `strip_pixels`, or as many as least_strip_rows have.
    ResidualFilm(bool filters, bool predicts, int strip_pixels = 1 << 20)
        : filters_(filters), predicts_(predicts), strip_pixels_(strip_pixels) {}

    /// The rows around a strip, which are filtered again with the next, are few against these.
    static constexpr int least_strip_rows = 128;

    /// Whether pixels must know their surroundings.
    [[nodiscard]] bool estimates_noise() const { return filters_ || predicts_; }
    /// How far away these are, pixels.
    [[nodiscard]] int reach() const;
    /// What a pass of so many pixels holds at the most.
    [[nodiscard]] std::size_t bytes(int width, int height) const;

    /// Begins a pass of rows of so many pixels: nothing has been found.
    void begin(int width);
    /// Makes room for the rows before `end`, of which nothing has been found. Only then pixels may be put.
    void take_in(int end);
    /// What a pixel's rays have found (not read without the filter), and how far it may be trusted. Pixels at
    /// once, each once. Only if it estimates noise.
    void put(int x, int y, const PixelResidual& residual, const PixelDoubt& doubt, const FilterGuide& guide);

    struct Adding {
        bool exact;   // maps do not err
        bool bright;  // there is bright light
        int threads;
    };
    /// Adds what was found, filtered, to those of `pixels` (the whole pass's) whose surroundings have been
    /// put, and what they are expected to be wrong by; forgets what no others need. Strip by strip: where
    /// strips begin changes nothing, as long as all of a pixel's surroundings are there.
    void add_to(std::span<PixelSums> pixels, const Adding& how);
    /// The same for all that were taken in: there are no more.
    void finish(std::span<PixelSums> pixels, const Adding& how);

  private:
    struct Part {
        Spectrum PixelResidual::*found;
        Spectrum SplitRadiance::*light;
    };
    [[nodiscard]] int strip_rows(int width) const;
    void add_rows(std::span<PixelSums> pixels, int end, const Adding& how);
    void add_kind(std::span<PixelSums> rows, NoiseEstimate PixelDoubt::*kind, const std::vector<Part>& parts,
                  int threads);
    void add_part(std::span<PixelSums> rows, const Part& part, const std::vector<Spectrum>& values) const;
    void forget_rows();
    [[nodiscard]] int rows_end() const { return first_row_ + guides_.height; }
    [[nodiscard]] std::size_t pixels_in(int rows) const {
        return static_cast<std::size_t>(rows) * static_cast<std::size_t>(guides_.width);
    }
    /// Of the next row to be added, among what is held.
    [[nodiscard]] std::size_t first_added() const { return pixels_in(next_row_ - first_row_); }

    bool filters_, predicts_;
    int strip_pixels_;
    // Of the rows that are held: from those around the next to be added on.
    int first_row_ = 0, next_row_ = 0;
    std::vector<PixelResidual> residuals_;
    std::vector<PixelDoubt> doubts_;
    FilterImage guides_;  // without values
};

}  // namespace relumine
