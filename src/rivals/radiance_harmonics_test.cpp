// SPDX-License-Identifier: Apache-2.0
// Radiance records against closed forms: irradiance, its gradient, and what lobes reflect of an even sky.
#include "rivals/radiance_harmonics.hpp"

#include <gtest/gtest.h>

#include "base/hash.hpp"
#include "cache/test_stage.hpp"
#include "rivals/lobe_harmonics.hpp"
#include "shading/reflectance.hpp"

namespace relumine {
namespace {

using testing::Quad;
using testing::Stage;

constexpr int bands = 10;

PolarHemisphere seen(const Stage& stage, Vec3 p, const Frame& frame, std::uint64_t key) {
    const FlushDenormals flush;
    const BrightSplit nothing_bright(stage.scene(), 1e6f);
    RayCounts counts;
    return trace_polar(stage.source(), nothing_bright, {p, frame, frame.n, 1e-5f, 0, 0, key},
                       polar_grid(Rings::even, 128), counts);
}

/// Σ of a record's coefficients times those of `lobe` (in `frame`), for a quantity and its derivatives.
std::array<double, 3> products(const RadianceHarmonics& radiance, const Frame& frame,
                               const HarmonicValues& lobe, std::size_t quantity) {
    std::vector<float> world(harmonic_count(bands));
    HarmonicRotation(bands, frame).turn(lobe, world);
    std::array<double, 3> sums{};
    for (std::size_t order = 0; order < 3; ++order)
        for (std::size_t i = 0; i < world.size(); ++i)
            sums[order] += static_cast<double>(world[i] * radiance.of(quantity, order)[i]);
    return sums;
}

const LobeHarmonics& lobes() {
    static const LobeHarmonics made(bands, Masking::correlated);
    return made;
}

/// GGX lobe of f0 = f90 = 1.
HarmonicValues lobe_of(float alpha, float cosine) {
    MetallicRoughness layers{};
    layers.specular_f0 = layers.specular_f90 = Spectrum{1};
    layers.ggx = {alpha, Masking::correlated};
    SpectralHarmonics out;
    lobes().reflection({}, layers, cosine, out);
    return out[0];
}

TEST(LobeHarmonics, ReflectOfAnEvenSkyWhatTheAlbedoSays) {
    const Stage stage({}, Spectrum{1});
    const Frame frame = frame_around(normalize({1, -2, 3}));
    const RadianceHarmonics sky = radiance_harmonics(seen(stage, {}, frame, 1), frame, bands);
    EXPECT_NEAR(products(sky, frame, lobes().cosine(), 0)[0], 1, 0.002);
    for (const float alpha : {0.35f, 0.6f, 1.0f})
        for (const float cosine : {1.0f, 0.7f, 0.3f}) {
            const LobeAlbedo albedo =
                lobe_albedo({{std::sqrt(1 - cosine * cosine), 0, cosine}}, {alpha, Masking::correlated});
            EXPECT_NEAR(products(sky, frame, lobe_of(alpha, cosine), 0)[0], albedo.f0 + albedo.f90, 0.02)
                << alpha << ' ' << cosine;
        }
}

/// What so few bands leave of a lobe: the least roughness is where they still hold nearly all its energy.
TEST(LobeHarmonics, HoldTheEnergyOfBroadLobesAlone) {
    const auto held = [](float alpha) {
        const LocalDir w_out{{0.6f, 0, 0.8f}};
        const RoughConductor metal{Spectrum{1}, {alpha, Masking::correlated}};
        HarmonicValues y;
        std::vector<double> sums(harmonic_count(bands));
        double energy = 0, kept = 0;
        constexpr int rows = 100, columns = 200;
        for (int i = 0; i < rows; ++i)
            for (int j = 0; j < columns; ++j) {
                const float z = (static_cast<float>(i) + 0.5f) / rows, r = std::sqrt(1 - sqr(z)),
                            phi = 2 * pi * (static_cast<float>(j) + 0.5f) / columns;
                const Vec3 d{r * std::cos(phi), r * std::sin(phi), z};
                const double f = eval(metal, w_out, {d}).r,
                             w = 2 * static_cast<double>(pi) / (rows * columns);
                energy += f * f * w;
                evaluate_harmonics(bands, d, y);
                for (std::size_t k = 0; k < sums.size(); ++k) sums[k] += f * w * static_cast<double>(y[k]);
            }
        for (const double c : sums) kept += c * c;
        return kept / energy;
    };
    EXPECT_GT(held(least_lobe_alpha(bands)), 0.97);
    EXPECT_LT(held(0.5f * least_lobe_alpha(bands)), 0.95);
}

constexpr float sky = 0.5f;

std::vector<Quad> walls() {
    return {{{1, -0.8f, 0.2f}, {0, 2, 0}, {0, 0, 1.5f}, Spectrum{3, 2, 1}},
            {{-0.9f, -0.2f, 0.4f}, {0.5f, 0.4f, 0}, {0, 0, 0.6f}, Spectrum{0}}};
}

/// Green light that the function `lobe` (in `frame`) takes in, by many directions: closed but for its sums.
double taken_in(Vec3 p, const Frame& frame, const HarmonicValues& lobe) {
    constexpr int rows = 160, columns = 640;
    HarmonicValues y;
    double sum = 0;
    for (int i = 0; i < rows; ++i)
        for (int j = 0; j < columns; ++j) {
            const float z = (static_cast<float>(i) + 0.5f) / rows, r = std::sqrt(1 - sqr(z)),
                        phi = 2 * pi * (static_cast<float>(j) + 0.5f) / columns;
            const LocalDir local{{r * std::cos(phi), r * std::sin(phi), z}};
            const Vec3 d = frame.to_world(local).v;
            float nearest = infinity, radiance = sky;
            for (const Quad& q : walls()) {
                const Vec3 n = cross(q.a, q.b);
                const float t = dot(q.corner - p, n) / dot(d, n);
                const Vec3 at = p + d * t - q.corner;
                const float u = dot(at, q.a) / length_squared(q.a), v = dot(at, q.b) / length_squared(q.b);
                if (t > 0 && t < nearest && u >= 0 && u <= 1 && v >= 0 && v <= 1) {
                    nearest = t;
                    radiance = q.radiance.g;
                }
            }
            evaluate_harmonics(bands, local.v, y);
            float f = 0;
            for (std::size_t k = 0; k < harmonic_count(bands); ++k) f += lobe[k] * y[k];
            sum += static_cast<double>(radiance * f) * 2 * static_cast<double>(pi) / (rows * columns);
        }
    return sum;
}

/// The error of the derivatives of what a lobe takes in, relative to their length; `change` may spoil the
/// strata.
template <typename Change>
double deviation(const HarmonicValues& lobe, const Change& change) {
    const Stage stage(walls(), Spectrum{sky});
    const Frame frame = frame_around({0, 0, 1});
    constexpr std::uint64_t records = 4;
    std::array<double, 3> mean{};
    for (std::uint64_t key = 0; key < records; ++key) {
        PolarHemisphere h = seen(stage, {}, frame, key);
        change(h);
        const auto one = products(radiance_harmonics(h, frame, bands), frame, lobe, 1);
        for (std::size_t i = 0; i < 3; ++i) mean[i] += one[i] / records;
    }
    constexpr float step = 0.04f;
    const auto difference = [&](Vec3 axis) {
        return (taken_in(axis * step, frame, lobe) - taken_in(axis * -step, frame, lobe))
               / (2 * static_cast<double>(step));
    };
    const double s = difference(frame.s), t = difference(frame.t);
    return std::hypot(mean[1] - s, mean[2] - t) / std::hypot(s, t);
}

TEST(RadianceHarmonics, GradientsAreThoseOfDifferences) {
    const auto nothing = [](PolarHemisphere&) {};
    const auto farther = [](PolarHemisphere& h) {
        for (PolarSample& s : h.samples) s.distance *= 1.25f;
    };
    EXPECT_LT(deviation(lobe_of(0.5f, 0.6f), nothing), 0.1);
    EXPECT_GT(deviation(lobe_of(0.5f, 0.6f), farther), 0.1);
}

}  // namespace
}  // namespace relumine
