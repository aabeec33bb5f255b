// SPDX-License-Identifier: Apache-2.0
// Statistical tests for tests: χ² of samples against a density, z of means.
#pragma once

#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

namespace relumine::testing {

/// The regularised upper incomplete gamma function Q(a, x): a series for x < a + 1, a continued fraction
/// beyond.
double upper_gamma(double a, double x);

/// The probability that a χ² variable of `degrees` exceeds `statistic`.
inline double chi_square_tail(double statistic, double degrees) {
    return upper_gamma(0.5 * degrees, 0.5 * statistic);
}

/// The p-value of observed counts against expected ones. Cells that expect fewer than 5 are pooled.
double chi_square_p(std::span<const double> observed, std::span<const double> expected);

/// The two-sided p-value of a standard normal variable.
inline double normal_p(double z) { return std::erfc(std::abs(z) / std::sqrt(2.0)); }

/// The two-sided p-value of a Student variable.
double student_p(double t, double degrees);

/// The level for each of `tests` independent tests that together reject wrongly with probability `total`
/// (Šidák).
inline double sidak(double total, double tests) { return 1 - std::pow(1 - total, 1 / tests); }

/// Mean and standard error of the mean of `count` values.
struct Estimate {
    double mean = 0, standard_error = 0, count = 0;
};
Estimate estimate(std::span<const double> values);

/// The two-sided p-value of two means being equal, variances unknown (Welch).
double welch_p(const Estimate& a, const Estimate& b);

}  // namespace relumine::testing
