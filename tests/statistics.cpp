// SPDX-License-Identifier: Apache-2.0
// Statistical tests for tests.
#include "tests/statistics.hpp"

#include <numeric>

namespace relumine::testing {
namespace {

double lower_series(double a, double x) {
    double term = 1 / a, sum = term;
    for (int n = 1; n < 10000 && std::abs(term) > 1e-16 * std::abs(sum); ++n) sum += term *= x / (a + n);
    return sum * std::exp(-x + a * std::log(x) - std::lgamma(a));
}

double upper_fraction(double a, double x) {  // Lentz's method
    constexpr double tiny = 1e-300;
    double b = x + 1 - a, c = 1 / tiny, d = 1 / b, h = d;
    for (int i = 1; i < 10000; ++i) {
        const double an = -i * (i - a);
        b += 2;
        d = 1 / (std::abs(an * d + b) < tiny ? tiny : an * d + b);
        c = std::abs(b + an / c) < tiny ? tiny : b + an / c;
        h *= d * c;
        if (std::abs(d * c - 1) < 1e-15) break;
    }
    return std::exp(-x + a * std::log(x) - std::lgamma(a)) * h;
}

/// The continued fraction of the incomplete beta function, by Lentz's method.
double beta_fraction(double a, double b, double x) {
    constexpr double tiny = 1e-300;
    const auto guard = [](double v) { return std::abs(v) < tiny ? tiny : v; };
    double c = 1, d = 1 / guard(1 - (a + b) * x / (a + 1)), h = d;
    for (int m = 1; m < 1000; ++m) {
        for (const double term : {m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m)),
                                  -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1))}) {
            d = 1 / guard(1 + term * d);
            c = guard(1 + term / c);
            h *= d * c;
        }
        if (std::abs(d * c - 1) < 1e-15) break;
    }
    return h;
}

/// The regularised incomplete beta function.
double incomplete_beta(double a, double b, double x) {
    if (x <= 0 || x >= 1) return x <= 0 ? 0 : 1;
    const double front =
        std::exp(std::lgamma(a + b) - std::lgamma(a) - std::lgamma(b) + a * std::log(x) + b * std::log1p(-x));
    return x < (a + 1) / (a + b + 2) ? front * beta_fraction(a, b, x) / a
                                     : 1 - front * beta_fraction(b, a, 1 - x) / b;
}

}  // namespace

double student_p(double t, double degrees) {
    return incomplete_beta(0.5 * degrees, 0.5, degrees / (degrees + t * t));
}

double welch_p(const Estimate& a, const Estimate& b) {
    const double va = a.standard_error * a.standard_error, vb = b.standard_error * b.standard_error;
    if (va + vb == 0) return a.mean == b.mean ? 1 : 0;
    const double degrees = (va + vb) * (va + vb) / (va * va / (a.count - 1) + vb * vb / (b.count - 1));
    return student_p((a.mean - b.mean) / std::sqrt(va + vb), degrees);
}

double upper_gamma(double a, double x) {
    if (x <= 0) return 1;
    return x < a + 1 ? 1 - lower_series(a, x) : upper_fraction(a, x);
}

double chi_square_p(std::span<const double> observed, std::span<const double> expected) {
    constexpr double least_expected = 5;
    double statistic = 0, pooled_observed = 0, pooled_expected = 0;
    int cells = 0;
    for (std::size_t i = 0; i < observed.size(); ++i) {
        if (expected[i] < least_expected) {
            pooled_observed += observed[i];
            pooled_expected += expected[i];
            continue;
        }
        statistic += (observed[i] - expected[i]) * (observed[i] - expected[i]) / expected[i];
        ++cells;
    }
    if (pooled_expected > 0 || pooled_observed > 0) {
        const double e = std::max(pooled_expected, 1e-3);  // counts where none belong must fail
        statistic += (pooled_observed - e) * (pooled_observed - e) / e;
        ++cells;
    }
    return cells < 2 ? 1 : chi_square_tail(statistic, cells - 1);
}

Estimate estimate(std::span<const double> values) {
    const auto n = static_cast<double>(values.size());
    const double mean = std::accumulate(values.begin(), values.end(), 0.0) / n;
    double squares = 0;
    for (const double value : values) squares += (value - mean) * (value - mean);
    return {mean, std::sqrt(squares / (n - 1) / n), n};
}

}  // namespace relumine::testing
