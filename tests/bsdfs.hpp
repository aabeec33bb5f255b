// SPDX-License-Identifier: Apache-2.0
// BSDFs, directions and integrals over them for the tests of shading.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <vector>

#include "base/sample_stream.hpp"
#include "shading/bsdf.hpp"
#include "shading/sampling.hpp"
#include "tests/statistics.hpp"

namespace relumine::testing {

inline constexpr int theta_cells = 40, phi_cells = 40;  // of the sphere

inline LocalDir direction(float cosine, float phi) {
    const float sine = std::sqrt(1 - sqr(cosine));
    return {{sine * std::cos(phi), sine * std::sin(phi), cosine}};
}

inline Ggx ggx(float alpha) { return {alpha, Masking::correlated}; }
inline Ggx ggx(float alpha_x, float alpha_y) { return make_ggx(alpha_x, alpha_y, Masking::correlated); }

/// A dielectric of index 1.5 over `diffuse`, which is not yet divided by the coat's mean transmittance.
inline MetallicRoughness plastic(Spectrum diffuse, float alpha) {
    return {diffuse, Spectrum{0.04f}, Spectrum{1}, Spectrum{0.04f}, Spectrum{1}, ggx(alpha)};
}

inline CoatedLayers coated(const MetallicRoughness& base, float clearcoat, float alpha) {
    CoatedLayers layers;
    layers.base = base;
    layers.clearcoat = clearcoat;
    layers.clearcoat_ggx = ggx(alpha);
    return layers;
}
inline CoatedLayers with_sheen(CoatedLayers layers, Spectrum color, float alpha) {
    layers.sheen = color;
    layers.sheen_alpha = alpha;
    return layers;
}

inline BsdfRandom random_numbers(std::uint64_t seed, std::uint32_t i) {
    const SampleStream stream{seed, i, 1, PointSet::independent};
    return {stream.next1(Dim::lobe), stream.next2(Dim::direction)};
}

using Density = std::function<double(LocalDir)>;

/// ∫ density over a cell of θ × φ, by the midpoint rule on a grid within the cell.
inline double cell_integral(const Density& density, int theta, int phi) {
    constexpr int fine = 12;
    const double dtheta = 3.14159265358979 / (theta_cells * fine),
                 dphi = 2 * 3.14159265358979 / (phi_cells * fine);
    double sum = 0;
    for (int i = 0; i < fine; ++i)
        for (int j = 0; j < fine; ++j) {
            const double t = (theta * fine + i + 0.5) * dtheta, p = (phi * fine + j + 0.5) * dphi;
            const double x = std::sin(t) * std::cos(p), y = std::sin(t) * std::sin(p), z = std::cos(t);
            sum += std::sin(t)
                   * density({{static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)}});
        }
    return sum * dtheta * dphi;
}

/// The share of a white environment's light that is reflected or transmitted towards w_out, by sampling.
inline Estimate directional_albedo(const Bsdf& bsdf, LocalDir w_out) {
    std::vector<double> weights;
    for (std::uint32_t i = 0; i < 100'000; ++i) {
        const auto s = sample(bsdf, w_out, random_numbers(3, i));
        weights.push_back(s ? s->weight.r * s->eta * s->eta
                            : 0.0);  // undo the radiance scaling of refraction
    }
    return estimate(weights);
}

/// The largest and the smallest albedo of white bodies in a white furnace, over views.
struct Extremes {
    double least = 1, most = 0;
    void add(const Bsdf& bsdf, float azimuth = 0) {
        for (const float cosine : {0.02f, 0.06f, 0.15f, 0.4f, 0.7f, 0.98f}) {
            const auto [mean, error, count] = directional_albedo(bsdf, direction(cosine, azimuth));
            least = std::min(least, mean);
            most = std::max(most, mean - 4 * error);
        }
    }
};

}  // namespace relumine::testing
