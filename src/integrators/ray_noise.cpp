// SPDX-License-Identifier: Apache-2.0
// Variances of sums over well spread points.
#include "integrators/ray_noise.hpp"

#include <algorithm>
#include <cmath>

namespace relumine {
namespace {

constexpr float fewest_rays = 16;  // below, halves and single rays are too much alike to tell them apart
constexpr float steepest = 3;      // a of smooth integrands
constexpr int bisections = 8;      // of [1, steepest]: to .01
constexpr float doubtful = 32;     // so many sources weigh as much as the doubt that points are well spread

/// The variance of the sum over that of independent rays, by the ratio that halves have to these.
float variance_share(float ratio, float rays) {
    if (ratio >= 1 || rays < fewest_rays) return 1;
    // n^(1 − a) (2^a − 1) falls with a, from 1 at a = 1
    float low = 1, high = steepest;
    for (int i = 0; i < bisections; ++i) {
        const float a = (low + high) / 2;
        (std::pow(rays, 1 - a) * (std::exp2(a) - 1) > ratio ? low : high) = a;
    }
    return std::pow(rays, 1 - (low + high) / 2);
}

}  // namespace

NoiseEstimate noise_of(const RayNoise& noise) {
    if (noise.rays < 2) return {noise.squares, noise.squares, noise.rays};
    const float sum = noise.halves[0] + noise.halves[1], difference = noise.halves[0] - noise.halves[1];
    const float spread = std::max(0.0f, noise.squares - sum * sum / noise.rays);
    return {spread * noise.rays / (noise.rays - 1), difference * difference, noise.rays};
}

float variance_of_sum(const NoiseEstimate& e) {
    if (!(e.independent > 0)) return 0;
    return e.independent * variance_share(e.halves / e.independent, e.rays);
}

float cautious_variance(const NoiseEstimate& e, float sources) {
    if (!(e.independent > 0)) return 0;
    const float ratio = (sources * e.halves / e.independent + doubtful) / (sources + doubtful);
    return e.independent * variance_share(ratio, e.rays) * (1 + 1 / std::sqrt(std::max(sources, 1.0f)));
}

}  // namespace relumine
