// SPDX-License-Identifier: Apache-2.0
// Tables of lobes.
#include "rivals/lobe_harmonics.hpp"

#include "shading/sampling.hpp"

namespace relumine {
namespace {

constexpr int cosines = 16, roughnesses = 8, strata = 32;

/// Entries stand for cos θ = (i / (cosines − 1))² and even steps of √α up from the least.
float cosine_at(int i) { return std::max(sqr(static_cast<float>(i) / (cosines - 1)), 1e-3f); }
float alpha_at(int j, int bands) {
    const float least = std::sqrt(std::min(1.0f, least_lobe_alpha(bands)));
    return sqr(lerp(least, 1.0f, static_cast<float>(j) / (roughnesses - 1)));
}

struct Place {
    int entry;
    float beyond;
};
Place place_in(float x, int count) {
    const float at = std::clamp(x, 0.0f, 1.0f) * static_cast<float>(count - 1);
    const int entry = std::min(static_cast<int>(at), count - 2);
    return {entry, at - static_cast<float>(entry)};
}

std::size_t entry_index(int i, int j) { return static_cast<std::size_t>(i * roughnesses + j); }

void add_scaled(std::size_t count, const HarmonicValues& values, float scale, HarmonicValues& sum) {
    for (std::size_t i = 0; i < count; ++i) sum[i] += values[i] * scale;
}

}  // namespace

LobeHarmonics::LobeHarmonics(int bands, Masking masking)
    : bands_(bands), entries_(static_cast<std::size_t>(cosines * roughnesses)) {
    constexpr int steps = 512;
    HarmonicValues y;
    for (int i = 0; i < steps; ++i) {  // over cos²θ, so that the cosine is part of the measure
        const float z = std::sqrt((static_cast<float>(i) + 0.5f) / steps);
        evaluate_polar_factors(bands, z, y);
        for (int l = 0; l < bands; ++l) cosine_[harmonic_index(l, 0)] += y[harmonic_index(l, 0)] / steps;
    }
    tabulate(masking);
}

void LobeHarmonics::tabulate(Masking masking) {
    const std::size_t count = harmonic_count(bands_);
    HarmonicValues y;
    for (int i = 0; i < cosines; ++i)
        for (int j = 0; j < roughnesses; ++j) {
            Entry& entry = entries_[entry_index(i, j)];
            const Ggx ggx{alpha_at(j, bands_), masking};
            const float z = cosine_at(i);
            const LocalDir w_out{{std::sqrt(1 - sqr(z)), 0, z}};
            for (int k = 0; k < strata * strata; ++k) {
                const Point2 u{(static_cast<float>(k % strata) + 0.5f) / strata,
                               (static_cast<float>(k / strata) + 0.5f) / strata};
                const LocalDir w_in = sample_reflection(ggx, w_out, u);
                if (cos_theta(w_in) <= 0) continue;
                const LocalDir h{normalize(w_out.v + w_in.v)};
                const float density = ggx_density(ggx, h);
                const float weight =
                    density * ggx_masking_shadowing(ggx, w_out, w_in)
                    / (4 * cos_theta(w_out) * reflection_pdf(ggx, w_out, density) * (strata * strata));
                const float x = 1 - dot(w_out.v, h.v), grazing = sqr(sqr(x)) * x;
                evaluate_harmonics(bands_, w_in.v, y);
                add_scaled(count, y, weight * (1 - grazing), entry.f0);
                add_scaled(count, y, weight * grazing, entry.f90);
            }
            for (int l = 1; l < bands_; ++l)  // the lobe is even in y; its samples nearly are
                for (int m = 1; m <= l; ++m)
                    entry.f0[harmonic_index(l, -m)] = entry.f90[harmonic_index(l, -m)] = 0;
        }
}

void LobeHarmonics::reflection(Spectrum diffuse, const MetallicRoughness& layers, float cos_out,
                               SpectralHarmonics& out) const {
    const std::size_t count = harmonic_count(bands_);
    for (HarmonicValues& channel : out) std::fill_n(channel.begin(), count, 0.0f);
    add_scaled(count, cosine_, diffuse.r, out[0]);
    add_scaled(count, cosine_, diffuse.g, out[1]);
    add_scaled(count, cosine_, diffuse.b, out[2]);
    const float least = std::sqrt(alpha_at(0, bands_));
    const Place i = place_in(std::sqrt(std::max(0.0f, cos_out)), cosines),
                j = place_in((std::sqrt(layers.ggx.alpha) - least) / std::max(1 - least, 1e-6f), roughnesses);
    for (int di = 0; di < 2; ++di)
        for (int dj = 0; dj < 2; ++dj) {
            const Entry& entry = entries_[entry_index(i.entry + di, j.entry + dj)];
            const float share = (di == 0 ? 1 - i.beyond : i.beyond) * (dj == 0 ? 1 - j.beyond : j.beyond);
            const Spectrum f0 = layers.specular_f0 * share, f90 = layers.specular_f90 * share;
            add_scaled(count, entry.f0, f0.r, out[0]);
            add_scaled(count, entry.f0, f0.g, out[1]);
            add_scaled(count, entry.f0, f0.b, out[2]);
            add_scaled(count, entry.f90, f90.r, out[0]);
            add_scaled(count, entry.f90, f90.g, out[1]);
            add_scaled(count, entry.f90, f90.b, out[2]);
        }
}

}  // namespace relumine
