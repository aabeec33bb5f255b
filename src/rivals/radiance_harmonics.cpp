// SPDX-License-Identifier: Apache-2.0
// Projection, and the gradient of coefficients by the strata's borders.
//
// As in irradiance.cpp, with the harmonic in place of the cosine: a border moves by dx cos θ / r in θ and by
// dx / (r sin θ) in φ, and what crosses it is the harmonic there times the radiance's step.
#include "rivals/radiance_harmonics.hpp"

namespace relumine {
namespace {

using Values = std::array<float, RadianceHarmonics::quantities>;

Values values_of(const PolarSample& s) {
    return {s.direct.r, s.direct.g, s.direct.b, s.indirect.r, s.indirect.g, s.indirect.b};
}

/// cos mφ for m ≥ 0, sin |m|φ below, at index bands − 1 + m.
using Waves = std::array<float, 2 * most_bands - 1>;

Waves waves_at(int bands, float phi) {
    Waves w{};
    for (int m = 1 - bands; m < bands; ++m) {
        const float angle = static_cast<float>(std::abs(m)) * phi;
        w[static_cast<std::size_t>(bands - 1 + m)] = m < 0 ? std::sin(angle) : std::cos(angle);
    }
    return w;
}

/// A direction in the tangent plane with its waves.
struct Azimuth {
    float s, t;
    Waves waves;
};

class Projection {
  public:
    Projection(const PolarHemisphere& h, int bands) : h_(h), bands_(bands), local_(bands) {
        for (int k = 0; k < h.grid.sectors; ++k) {
            const float middle = h.grid.azimuth(static_cast<float>(k) + 0.5f),
                        border = h.grid.azimuth(static_cast<float>(k));
            along_.push_back({std::cos(middle), std::sin(middle), waves_at(bands, middle)});
            across_.push_back({-std::sin(border), std::cos(border), waves_at(bands, border)});
        }
    }

    RadianceHarmonics run(const Frame& frame) {
        add_values();
        for (int ring = 0; ring < h_.grid.rings; ++ring) {
            if (ring > 0) add_ring_border(ring);
            add_sector_borders(ring);
        }
        RadianceHarmonics world(bands_);
        const HarmonicRotation rotation(bands_, frame);
        for (std::size_t q = 0; q < RadianceHarmonics::quantities; ++q)
            for (std::size_t order = 0; order < RadianceHarmonics::orders; ++order)
                rotation.turn(local_.of(q, order), world.of(q, order));
        return world;
    }

  private:
    using Sums = std::array<Waves, RadianceHarmonics::quantities>;

    void add_values() {
        HarmonicValues y;
        const float share = 2 * pi / static_cast<float>(h_.grid.size());
        for (const PolarSample& s : h_.samples) {
            if (!s.open) continue;
            evaluate_harmonics(bands_, s.direction.v, y);
            const Values values = values_of(s);
            for (std::size_t q = 0; q < values.size(); ++q) {
                if (values[q] == 0) continue;
                const std::span<float> sum = local_.of(q, 0);
                for (std::size_t i = 0; i < harmonic_count(bands_); ++i) sum[i] += values[q] * share * y[i];
            }
        }
    }

    /// The step of radiance over a border and what part of it one metre of move brings.
    void add_step(const PolarSample& from, const PolarSample& to, float moved, const Azimuth& way, Sums& s,
                  Sums& t) const {
        const float nearer = std::min(from.distance, to.distance);
        if (!from.open || !to.open || !(nearer < infinity)) return;
        const Values before = values_of(from), after = values_of(to);
        for (std::size_t q = 0; q < before.size(); ++q) {
            const float step = (after[q] - before[q]) * moved / nearer;
            if (step == 0) continue;
            for (std::size_t m = 0; m < waves(); ++m) {
                s[q][m] += step * way.s * way.waves[m];
                t[q][m] += step * way.t * way.waves[m];
            }
        }
    }

    void add_ring_border(int ring) {
        Sums s{}, t{};
        const float cosine = h_.grid.cosine(static_cast<float>(ring));
        const float moved =
            2 * pi / static_cast<float>(h_.grid.sectors) * std::sqrt(1 - sqr(cosine)) * cosine;
        for (int k = 0; k < h_.grid.sectors; ++k)
            add_step(h_.at(ring - 1, k), h_.at(ring, k), moved, along_[static_cast<std::size_t>(k)], s, t);
        add_sums(cosine, s, t);
    }

    void add_sector_borders(int ring) {
        Sums s{}, t{};
        const float upper = std::acos(h_.grid.cosine(static_cast<float>(ring))),
                    lower = std::acos(h_.grid.cosine(static_cast<float>(ring + 1)));
        for (int k = 0; k < h_.grid.sectors; ++k) {
            const int before = (k + h_.grid.sectors - 1) % h_.grid.sectors;
            add_step(h_.at(ring, before), h_.at(ring, k), lower - upper, across_[static_cast<std::size_t>(k)],
                     s, t);
        }
        add_sums(std::cos(0.5f * (upper + lower)), s, t);
    }

    /// Waves times the polar factors at one angle.
    void add_sums(float cosine, const Sums& s, const Sums& t) {
        HarmonicValues polar;
        evaluate_polar_factors(bands_, cosine, polar);
        for (std::size_t q = 0; q < s.size(); ++q) {
            const std::span<float> along_s = local_.of(q, 1), along_t = local_.of(q, 2);
            for (int l = 0; l < bands_; ++l)
                for (int m = -l; m <= l; ++m) {
                    const float factor = polar[harmonic_index(l, std::abs(m))];
                    const auto wave = static_cast<std::size_t>(bands_ - 1 + m);
                    along_s[harmonic_index(l, m)] += factor * s[q][wave];
                    along_t[harmonic_index(l, m)] += factor * t[q][wave];
                }
        }
    }

    [[nodiscard]] std::size_t waves() const { return static_cast<std::size_t>(2 * bands_ - 1); }

    const PolarHemisphere& h_;
    int bands_;
    RadianceHarmonics local_;
    std::vector<Azimuth> along_, across_;  // per sector
};

}  // namespace

RadianceHarmonics radiance_harmonics(const PolarHemisphere& hemisphere, const Frame& frame, int bands) {
    return Projection(hemisphere, bands).run(frame);
}

}  // namespace relumine
