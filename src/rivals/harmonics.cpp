// SPDX-License-Identifier: Apache-2.0
// Legendre recurrences, and the recursion over bands of rotation matrices.
#include "rivals/harmonics.hpp"

#include "base/assert.hpp"

namespace relumine {
namespace {

/// Where the matrix of band l begins.
constexpr std::size_t begin_of(int l) { return static_cast<std::size_t>(l * (2 * l - 1) * (2 * l + 1) / 3); }

/// The factors of the recursion's three terms [Ivanic96, table 1].
struct Factors {
    float u, v, w;
};

Factors factors(int l, int m, int n) {
    const double below = std::abs(n) == l ? 2.0 * l * (2 * l - 1) : static_cast<double>((l + n) * (l - n));
    const int a = std::abs(m);
    const double zero = m == 0 ? 1 : 0;
    return {static_cast<float>(std::sqrt((l + m) * (l - m) / below)),
            static_cast<float>(0.5 * std::sqrt((1 + zero) * (l + a - 1) * (l + a) / below) * (1 - 2 * zero)),
            static_cast<float>(-0.5 * std::sqrt((l - a - 1) * (l - a) / below) * (1 - zero))};
}

/// Of all elements of all bands, laid out as the matrices are.
const std::vector<Factors>& all_factors() {
    static const std::vector<Factors> all = [] {
        std::vector<Factors> made(begin_of(most_bands));
        for (int l = 2; l < most_bands; ++l)
            for (int m = -l; m <= l; ++m)
                for (int n = -l; n <= l; ++n)
                    made[begin_of(l) + static_cast<std::size_t>((m + l) * (2 * l + 1) + n + l)] =
                        factors(l, m, n);
        return made;
    }();
    return all;
}

/// √((2l + 1)/4π · (l − m)!/(l + m)!), times √2 for m > 0.
struct Norms {
    std::array<float, harmonic_count(most_bands)> of{};
    Norms() {
        for (int l = 0; l < most_bands; ++l)
            for (int m = 0; m <= l; ++m) {
                double ratio = 1;
                for (int k = l - m + 1; k <= l + m; ++k) ratio /= k;
                of[harmonic_index(l, m)] = static_cast<float>(
                    std::sqrt((m > 0 ? 2 : 1) * (2 * l + 1) / (4 * static_cast<double>(pi)) * ratio));
            }
    }
};

}  // namespace

void evaluate_polar_factors(int bands, float cosine, HarmonicValues& values) {
    static const Norms norms;
    const double z = cosine, sine = std::sqrt(std::max(0.0, 1 - z * z));
    double diagonal = 1;  // P of degree and order m
    for (int m = 0; m < bands; ++m) {
        double before = 0, now = diagonal;
        for (int l = m; l < bands; ++l) {
            const std::size_t i = harmonic_index(l, m);
            values[i] = static_cast<float>(now * static_cast<double>(norms.of[i]));
            const double next = ((2 * l + 1) * z * now - (l + m) * before) / (l + 1 - m);
            before = now;
            now = next;
        }
        diagonal *= (2 * m + 1) * sine;
    }
}

void evaluate_harmonics(int bands, Vec3 direction, HarmonicValues& values) {
    evaluate_polar_factors(bands, direction.z, values);
    const float r = std::sqrt(sqr(direction.x) + sqr(direction.y));
    const float x = r > 0 ? direction.x / r : 1, y = r > 0 ? direction.y / r : 0;
    float cosine = 1, sine = 0;  // of mφ
    for (int m = 1; m < bands; ++m) {
        const float next = cosine * x - sine * y;
        sine = sine * x + cosine * y;
        cosine = next;
        for (int l = m; l < bands; ++l) {
            const float factor = values[harmonic_index(l, m)];
            values[harmonic_index(l, m)] = factor * cosine;
            values[harmonic_index(l, -m)] = factor * sine;
        }
    }
}

HarmonicRotation::HarmonicRotation(int bands, const Frame& frame)
    : bands_(bands), matrices_(begin_of(bands)) {
    RELUMINE_ASSERT(bands >= 2 && bands <= most_bands);
    matrices_[0] = 1;
    const std::array axes{frame.t, frame.n, frame.s};  // own y, z, x
    for (std::size_t n = 0; n < 3; ++n) {
        const std::array to{axes[n].y, axes[n].z, axes[n].x};
        for (std::size_t m = 0; m < 3; ++m) matrices_[1 + 3 * m + n] = to[m];
    }
    for (int l = 2; l < bands; ++l)
        for (int m = -l; m <= l; ++m)
            for (int n = -l; n <= l; ++n)
                matrices_[begin_of(l) + static_cast<std::size_t>((m + l) * (2 * l + 1) + n + l)] =
                    element(l, m, n);
}

float HarmonicRotation::at(int l, int m, int n) const {
    return matrices_[begin_of(l) + static_cast<std::size_t>((m + l) * (2 * l + 1) + n + l)];
}

/// P of [Ivanic96, table 2].
float HarmonicRotation::product(int i, int l, int m, int n) const {
    if (n == l) return at(1, i, 1) * at(l - 1, m, l - 1) - at(1, i, -1) * at(l - 1, m, 1 - l);
    if (n == -l) return at(1, i, 1) * at(l - 1, m, 1 - l) + at(1, i, -1) * at(l - 1, m, l - 1);
    return at(1, i, 0) * at(l - 1, m, n);
}

float HarmonicRotation::element(int l, int m, int n) const {
    const Factors f = all_factors()[begin_of(l) + static_cast<std::size_t>((m + l) * (2 * l + 1) + n + l)];
    constexpr float root2 = 1.41421356f;
    float sum = f.u != 0 ? f.u * product(0, l, m, n) : 0;
    if (m == 0) return sum + f.v * (product(1, l, 1, n) + product(-1, l, -1, n));
    const int a = std::abs(m);
    const bool one = a == 1;
    if (m > 0) {
        sum += f.v * (product(1, l, m - 1, n) * (one ? root2 : 1) - (one ? 0 : product(-1, l, 1 - m, n)));
        if (f.w != 0) sum += f.w * (product(1, l, m + 1, n) + product(-1, l, -m - 1, n));
        return sum;
    }
    sum += f.v * ((one ? 0 : product(1, l, m + 1, n)) + product(-1, l, -m - 1, n) * (one ? root2 : 1));
    if (f.w != 0) sum += f.w * (product(1, l, m - 1, n) - product(-1, l, 1 - m, n));
    return sum;
}

void HarmonicRotation::turn(std::span<const float> coefficients, std::span<float> turned) const {
    for (int l = 0; l < bands_; ++l) {
        const auto width = static_cast<std::size_t>(2 * l + 1);
        const std::size_t first = harmonic_index(l, -l);
        const float* row = &matrices_[begin_of(l)];
        for (std::size_t m = 0; m < width; ++m, row += width) {
            float sum = 0;
            for (std::size_t n = 0; n < width; ++n) sum += row[n] * coefficients[first + n];
            turned[first + m] = sum;
        }
    }
}

}  // namespace relumine
