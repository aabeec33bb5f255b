// SPDX-License-Identifier: Apache-2.0
// Smoothing what was found, part by part.
#include "integrators/residual_film.hpp"

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

std::size_t ResidualFilm::bytes_per_pixel() const {
    constexpr std::size_t parts = 2;  // direct and indirect light, with their weights and variances
    constexpr std::size_t filtering =
        sizeof(FilterGuide) + (1 + parts) * sizeof(Spectrum) + sizeof(float) + smoothing_bytes(parts);
    return (filters_ ? sizeof(PixelResidual) + filtering : 0)
           + (estimates_noise() ? sizeof(FilterGuide) + sizeof(PixelDoubt) : 0);
}

void ResidualFilm::begin(int width, int height) {
    const std::size_t count = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    residuals_.assign(filters_ ? count : 0, {});
    doubts_.assign(estimates_noise() ? count : 0, {});
    guides_ = {width, height, std::vector<FilterGuide>(estimates_noise() ? count : 0), {}, {}};
}

void ResidualFilm::put(std::size_t pixel, const PixelResidual& residual, const PixelDoubt& doubt,
                       const FilterGuide& guide) {
    if (filters_) residuals_[pixel] = residual;
    doubts_[pixel] = doubt;
    guides_.guides[pixel] = guide;
}

void ResidualFilm::add_to(std::span<PixelSums> pixels, bool exact, bool bright, int threads) {
    if (!estimates_noise()) return;
    add_kind(pixels, &PixelDoubt::residual,
             {{&PixelResidual::direct, &SplitRadiance::direct},
              {&PixelResidual::indirect, &SplitRadiance::indirect}},
             threads);
    if (bright)
        add_kind(pixels, &PixelDoubt::bright, {{&PixelResidual::bright, &SplitRadiance::direct}}, threads);
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        pixels[i].error.variance += doubts_[i].samples_variance;
        if (!exact) pixels[i].error.deviation += deviation_left(doubts_[i]);
    }
}

/// Parts of one kind: divided by what the surface reflects, smoothed, and multiplied again. Quotients count
/// by what they are divided by, so that nothing is gained or lost where they depend on it: few rays'
/// residuals of dark pixels between bright ones are much larger quotients.
void ResidualFilm::add_kind(std::span<PixelSums> pixels, NoiseEstimate PixelDoubt::*kind,
                            const std::vector<Part>& parts, int threads) {
    std::vector<float> variances = noise_variances(guides_, doubts_, kind, threads);
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
        variances = smooth_noise(std::move(weighed), values, variances, filter_levels, threads);
        for (std::size_t k = 0; k < parts.size(); ++k) add_part(pixels, parts[k], values[k]);
    }
    for (std::size_t i = 0; i < pixels.size(); ++i)
        pixels[i].error.variance += variances[i] * sqr(doubts_[i].albedo);
}

void ResidualFilm::add_part(std::span<PixelSums> pixels, const Part& part,
                            const std::vector<Spectrum>& values) const {
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        const Spectrum sum = values[i] * residuals_[i].albedo;
        pixels[i].radiance += sum;
        pixels[i].split.*part.light += sum;
    }
}

}  // namespace relumine
