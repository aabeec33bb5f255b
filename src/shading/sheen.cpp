// SPDX-License-Identifier: Apache-2.0
// Sheen: cloth whose fibres stand up, brightest at grazing angles [Estevez17].
#include <array>

#include "shading/coat.hpp"

namespace relumine {
namespace {

/// Fits of Λ for the distribution that sin^(1/α) θ makes [Estevez17, table 1].
struct LambdaFit {
    float a, b, c, d, e;
};
LambdaFit lambda_fit(float alpha) {
    const float t = sqr(1 - alpha);
    const auto mix = [&](float rough, float smooth) { return rough + (smooth - rough) * t; };
    return {mix(21.5473f, 25.3245f), mix(3.82987f, 3.32435f), mix(0.19823f, 0.16801f),
            mix(-1.97760f, -1.27393f), mix(-4.32054f, -4.85967f)};
}

float lambda_exponent(float x, float alpha) {
    const auto [a, b, c, d, e] = lambda_fit(alpha);
    return a / (1 + b * std::pow(x, c)) + d * x + e;
}

float lambda(float cosine, float alpha) {
    return cosine < 0.5f ? std::exp(lambda_exponent(cosine, alpha))
                         : std::exp(2 * lambda_exponent(0.5f, alpha)
                                    - lambda_exponent(std::max(1 - cosine, 0.0f), alpha));
}

/// D·V as published, which reflects up to 1.6 times what arrives at grazing angles.
float published_lobe(float alpha, LocalDir w_out, LocalDir w_in) {
    const Vec3 sum = w_out.v + w_in.v;
    const float sine2 = (sqr(sum.x) + sqr(sum.y)) / std::max(length_squared(sum), 1e-20f);
    const float density = (2 + 1 / alpha) * std::pow(sine2, 0.5f / alpha) * (0.5f * inv_pi);
    const float out = cos_theta(w_out), in = std::max(cos_theta(w_in), 1e-6f);
    return density / ((1 + lambda(out, alpha) + lambda(in, alpha)) * 4 * out * in);
}

constexpr int cosines = sheen_cosines, roughnesses = 24;

/// Entries stand for cos θ = (i / (cosines − 1))², and for roughnesses √α in even steps.
float cosine_at(int i) { return std::max(sqr(static_cast<float>(i) / (cosines - 1)), 1e-3f); }
const float least_roughness = std::sqrt(least_sheen_alpha);
float alpha_at(int j) { return sqr(lerp(least_roughness, 1.0f, static_cast<float>(j) / (roughnesses - 1))); }

/// Midpoints over √cos θ of w_in, which are dense near the horizon, and over its azimuth, from 0 to π for the
/// symmetry.
float integrate(float cosine, float alpha) {
    constexpr int side = 64;
    const LocalDir w_out{{std::sqrt(1 - sqr(cosine)), 0, cosine}};
    float sum = 0;
    for (int i = 0; i < side; ++i)
        for (int j = 0; j < side; ++j) {
            const float root = (static_cast<float>(i) + 0.5f) / side, in = sqr(root),
                        sine = std::sqrt(1 - sqr(in));
            const float phi = pi * (static_cast<float>(j) + 0.5f) / side;
            sum +=
                published_lobe(alpha, w_out, {{sine * std::cos(phi), sine * std::sin(phi), in}}) * root * in;
        }
    return sum * 4 * pi / (side * side);
}

struct Table {
    std::array<std::array<float, roughnesses>, cosines> albedo{};

    Table() {
        for (int i = 0; i < cosines; ++i)
            for (int j = 0; j < roughnesses; ++j)
                albedo[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)] =
                    integrate(cosine_at(i), alpha_at(j));
    }
};

struct Place {
    std::size_t entry;
    float beyond;
};
/// Where `x` in [0, 1] lies between two entries of a table of `count` even steps.
Place place_of(float x, int count) {
    const float at = std::clamp(x, 0.0f, 1.0f) * static_cast<float>(count - 1);
    const int entry = std::min(static_cast<int>(at), count - 2);
    return {static_cast<std::size_t>(entry), at - static_cast<float>(entry)};
}

Place roughness_place(float alpha) {
    return place_of((std::sqrt(alpha) - least_roughness) / (1 - least_roughness), roughnesses);
}

/// Of entry `cosine` of the table.
float tabulated_albedo(std::size_t cosine, const Place& roughness) {
    static const Table table;
    const auto& row = table.albedo[cosine];
    return lerp(row[roughness.entry], row[roughness.entry + 1], roughness.beyond);
}

float published_albedo(float cosine, float alpha) {
    const Place i = place_of(std::sqrt(std::max(cosine, 0.0f)), cosines), j = roughness_place(alpha);
    return lerp(tabulated_albedo(i.entry, j), tabulated_albedo(i.entry + 1, j), i.beyond);
}

}  // namespace

float sheen_lobe(float alpha, LocalDir w_out, LocalDir w_in) {
    const float most = std::max(published_albedo(cos_theta(w_out), alpha),
                                published_albedo(std::max(cos_theta(w_in), 0.0f), alpha));
    return published_lobe(alpha, w_out, w_in) / std::max(most, 1.0f);
}

float sheen_albedo(float cosine, float alpha) { return std::min(published_albedo(cosine, alpha), 1.0f); }

SheenCurves sheen_curves(float alpha) {
    const auto [a, b, c, d, e] = lambda_fit(alpha);
    SheenCurves curves{a, b, c, d, e, {}};
    const Place roughness = roughness_place(alpha);
    for (std::size_t i = 0; i < curves.albedo.size(); ++i) curves.albedo[i] = tabulated_albedo(i, roughness);
    return curves;
}

}  // namespace relumine
