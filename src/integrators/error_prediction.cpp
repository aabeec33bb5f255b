// SPDX-License-Identifier: Apache-2.0
// From the spread of rays and the maps' own doubt to the error of pixels.
#include "integrators/error_prediction.hpp"

namespace relumine {
namespace {

/// What n rays may miss altogether is a deviation of so much of MapIntegral::deviation() over √n.
constexpr float unseen = 0.3f;

constexpr float least_albedo = 1e-5f;  // that anything is divided by

/// Samples are spread well over the pixel: of an edge through it, only those near the edge are in doubt.
float variance_of_samples(float count, float sum, float squares) {
    if (count < 2) return 0;
    const float spread = std::max(0.0f, squares - sum * sum / count) / (count - 1);
    return spread * std::sqrt(count);
}

/// So many of the pixels that a mean comes from matter in it, by the mean of their squares and what such
/// means leave of the variance of independent values: a single rare find is one source.
float sources_of(float mean, float mean_square, float variance_left) {
    if (!(mean_square > 0)) return 1;
    return std::max(1.0f, mean * (mean / mean_square) / variance_left);
}

}  // namespace

void DoubtSum::add(const SampledRadiance& found, const SampledRadiance& lobes, Spectrum throughput,
                   Spectrum light, Spectrum albedo, float deviation) {
    const float factor = luminance(throughput), l = luminance(light);
    residual_.add(found.residual.noise, factor);
    cone_.add(found.cones.noise, factor);
    light_.add(found.light.noise, factor);
    hit_.add(found.residual.bright.noise, factor);
    lobe_.add(lobes.residual.noise, factor);
    mirrored_light_.add(found.light.mirrored_noise, factor);
    mirrored_light_.add(lobes.light.noise, factor);
    mirrored_hit_.add(found.residual.bright.mirrored_noise, factor);
    mirrored_hit_.add(lobes.residual.bright.noise, factor);
    albedo_ += luminance(throughput * albedo);
    deviation_ += factor * deviation;
    samples_ += 1;
    sum_ += l;
    squares_ += l * l;
}

PixelDoubt DoubtSum::finish() const {
    PixelDoubt doubt{noise_of(residual_), noise_of(light_), albedo_, deviation_,
                     variance_of_samples(samples_, sum_, squares_)};
    for (const RayNoise* noise : {&lobe_, &mirrored_light_, &mirrored_hit_})
        doubt.unfiltered_variance += variance_of_sum(noise_of(*noise));
    doubt.residual.add(noise_of(cone_));
    doubt.residual.independent += sqr(unseen * deviation_) / std::max(residual_.rays, 1.0f);
    doubt.bright.add(noise_of(hit_));
    return doubt;
}

float deviation_left(const PixelDoubt& doubt) {
    constexpr float alone = 0.2f;                     // [sim]
    constexpr float of_one_ray = 0.1f, power = 0.3f;  // differences that the filter takes for noise
    if (doubt.residual.rays < 1) return alone * doubt.deviation;
    return std::min(alone, of_one_ray * std::pow(doubt.residual.rays, -power)) * doubt.deviation;
}

NoiseVariances noise_variances(const FilterImage& guides, std::span<const PixelDoubt> doubts,
                               NoiseEstimate PixelDoubt::*kind, int threads) {
    FilterParts around(2);  // noise, and its squares
    for (auto& part : around) part.reserve(doubts.size());
    for (const PixelDoubt& d : doubts) {
        const float scale = d.albedo > least_albedo ? 1 / sqr(d.albedo) : 0;
        const NoiseEstimate& noise = d.*kind;
        around[0].push_back({noise.independent * scale, noise.halves * scale, noise.rays});
        around[1].emplace_back(sqr(noise.independent * scale));
    }
    FilterParts left(1, std::vector<Spectrum>(doubts.size(), Spectrum{1}));
    filter_along_surfaces(guides, around, left, noise_levels, threads);
    NoiseVariances variances;
    variances.expected.reserve(doubts.size());
    variances.cautious.reserve(doubts.size());
    for (std::size_t i = 0; i < doubts.size(); ++i) {
        const Spectrum& mean = around[0][i];
        const NoiseEstimate estimate{mean.r, mean.g, mean.b};
        variances.expected.push_back(variance_of_sum(estimate));
        variances.cautious.push_back(
            cautious_variance(estimate, sources_of(mean.r, around[1][i].r, left[0][i].r)));
    }
    return variances;
}

}  // namespace relumine
