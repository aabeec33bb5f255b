// SPDX-License-Identifier: Apache-2.0
// Smoothing what was found, part by part.
#include "integrators/residual_film.hpp"

#include <algorithm>

#include "blocks/block_partition.hpp"

namespace relumine {
namespace {

constexpr int filter_levels = 3;

Spectrum divided(Spectrum a, Spectrum b) {
    const auto channel = [](float x, float y) { return y > 1e-6f ? x / y : 0.0f; };
    return {channel(a.r, b.r), channel(a.g, b.g), channel(a.b, b.b)};
}

}  // namespace

int ResidualFilm::reach() const {
    if (filters_) return smoothing_reach(filter_levels);
    return predicts_ ? filter_reach(noise_levels) : 0;
}

int ResidualFilm::strip_rows(int width) const {
    return std::max(least_strip_rows, strip_pixels_ / std::max(width, 1));
}

std::size_t ResidualFilm::bytes(int width, int height) const {
    constexpr std::size_t parts = 2;  // direct and indirect light, with their weights and variances
    constexpr std::size_t filtering =
        sizeof(FilterGuide) + (1 + parts) * sizeof(Spectrum) + sizeof(float) + smoothing_bytes(parts);
    const std::size_t per_pixel = (filters_ ? sizeof(PixelResidual) + filtering : 0)
                                  + (estimates_noise() ? sizeof(FilterGuide) + sizeof(PixelDoubt) : 0);
    const int rows = std::min(height, strip_rows(width) + 2 * reach() + cell_pixels);
    return per_pixel * static_cast<std::size_t>(rows) * static_cast<std::size_t>(width);
}

void ResidualFilm::begin(int width) {
    residuals_.clear();
    doubts_.clear();
    guides_ = {width, 0, {}, {}, {}};
    first_row_ = next_row_ = 0;
}

void ResidualFilm::take_in(int end) {
    if (!estimates_noise()) return;
    guides_.height = end - first_row_;
    const std::size_t count = pixels_in(guides_.height);
    if (filters_) residuals_.resize(count);
    doubts_.resize(count);
    guides_.guides.resize(count);
}

void ResidualFilm::put(int x, int y, const PixelResidual& residual, const PixelDoubt& doubt,
                       const FilterGuide& guide) {
    const std::size_t pixel = pixels_in(y - first_row_) + static_cast<std::size_t>(x);
    if (filters_) residuals_[pixel] = residual;
    doubts_[pixel] = doubt;
    guides_.guides[pixel] = guide;
}

void ResidualFilm::add_to(std::span<PixelSums> pixels, const Adding& how) {
    for (const int rows = strip_rows(guides_.width); next_row_ + rows + reach() <= rows_end();)
        add_rows(pixels, next_row_ + rows, how);
}

void ResidualFilm::finish(std::span<PixelSums> pixels, const Adding& how) {
    add_to(pixels, how);
    if (next_row_ < rows_end()) add_rows(pixels, rows_end(), how);
}

/// The rows from next_row_ on; all around them are held.
void ResidualFilm::add_rows(std::span<PixelSums> pixels, int end, const Adding& how) {
    const std::span rows = pixels.subspan(pixels_in(next_row_), pixels_in(end - next_row_));
    if (filters_) find_contacts(guides_, how.threads);
    add_kind(rows, &PixelDoubt::residual,
             {{&PixelResidual::direct, &SplitRadiance::direct},
              {&PixelResidual::indirect, &SplitRadiance::indirect}},
             how.threads);
    if (how.bright)
        add_kind(rows, &PixelDoubt::bright, {{&PixelResidual::bright, &SplitRadiance::direct}}, how.threads);
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const PixelDoubt& doubt = doubts_[first_added() + i];
        rows[i].error.variance += doubt.unfiltered_variance;
        if (!how.exact) rows[i].error.deviation += deviation_left(doubt);
    }
    next_row_ = end;
    forget_rows();
}

/// Those that are around no row that is still to be added.
void ResidualFilm::forget_rows() {
    const int rows = next_row_ - reach() - first_row_;
    if (rows <= 0) return;
    const auto forget = [&](auto& values) {
        if (!values.empty())
            values.erase(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(pixels_in(rows)));
    };
    forget(residuals_);
    forget(doubts_);
    forget(guides_.guides);
    first_row_ += rows;
    guides_.height -= rows;
}

/// Parts of one kind: divided by what the surface reflects, smoothed, and multiplied again. Quotients count
/// by what they are divided by, so that nothing is gained or lost where they depend on it: few rays'
/// residuals of dark pixels between bright ones are much larger quotients.
void ResidualFilm::add_kind(std::span<PixelSums> rows, NoiseEstimate PixelDoubt::*kind,
                            const std::vector<Part>& parts, int threads) {
    NoiseVariances noise = noise_variances(guides_, doubts_, kind, threads);
    if (filters_) {
        FilterImage weighed = guides_;
        weighed.weights.reserve(residuals_.size());
        for (const PixelResidual& r : residuals_) weighed.weights.push_back(r.albedo);
        FilterParts values(parts.size());
        for (std::size_t k = 0; k < parts.size(); ++k) {
            values[k].reserve(residuals_.size());
            for (const PixelResidual& r : residuals_)
                values[k].push_back(divided(r.*parts[k].found, r.albedo));
        }
        noise.expected = smooth_noise(std::move(weighed), values, noise, filter_levels, threads);
        for (std::size_t k = 0; k < parts.size(); ++k) add_part(rows, parts[k], values[k]);
    }
    for (std::size_t i = 0; i < rows.size(); ++i)
        rows[i].error.variance += noise.expected[first_added() + i] * sqr(doubts_[first_added() + i].albedo);
}

void ResidualFilm::add_part(std::span<PixelSums> rows, const Part& part,
                            const std::vector<Spectrum>& values) const {
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const Spectrum sum = values[first_added() + i] * residuals_[first_added() + i].albedo;
        rows[i].radiance += sum;
        rows[i].split.*part.light += sum;
    }
}

}  // namespace relumine
