// SPDX-License-Identifier: Apache-2.0
// What the spread of the rays of a pixel says of the error of their sum.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

namespace relumine {

/// What the rays of one pixel have found that are successive points of one sequence: luminance, each as much
/// as it adds to their sum.
struct RayNoise {
    std::array<float, 2> halves{};  // sums over the sequence's first half and its second
    float squares = 0;
    float rays = 0;  // those that found nothing included

    void count(bool second_half, float found) {
        halves[second_half ? 1 : 0] += found;
        squares += found * found;
    }
    void add(const RayNoise& other, float factor) {
        for (std::size_t i = 0; i < 2; ++i) halves[i] += factor * other.halves[i];
        squares += factor * factor * other.squares;
        rays += other.rays;
    }
};

/// Of what the same rays have found by two ways.
[[nodiscard]] inline RayNoise together(const RayNoise& a, const RayNoise& b) {
    RayNoise sum = a;
    sum.add(b, 1);
    sum.rays = a.rays;
    return sum;
}

/// Two estimates of the variance of the sum, and how many rays they come from: averages over pixels mean
/// more than those of one.
struct NoiseEstimate {
    float independent = 0;  // as if the rays were
    float halves = 0;       // as if the sequence's halves were
    float rays = 0;

    void add(const NoiseEstimate& other) {
        independent += other.independent;
        halves += other.halves;
        rays = std::max(rays, other.rays);
    }
};
[[nodiscard]] NoiseEstimate noise_of(const RayNoise& noise);

/// The variance of the sum where it falls as a power of the number of rays, n^-a: halves that are independent
/// then differ by n^-a (2^a − 1), single rays by n^-1, and the ratio of the two tells a. Well spread points
/// gain much where the integrand is smooth and nothing where it is noise.
[[nodiscard]] float variance_of_sum(const NoiseEstimate& estimate);

/// What it may well be if the estimate is a mean over so many independent ones: of the ratio so much is
/// believed as there are, and the variance is raised by its own relative error. Few rare finds, most of all,
/// must not be taken for what is well known because they happen to lie in both halves.
[[nodiscard]] float cautious_variance(const NoiseEstimate& estimate, float sources);

}  // namespace relumine
