// SPDX-License-Identifier: Apache-2.0
// Real spherical harmonics: values, and the rotation of coefficients.
//
// Coefficient l (l + 1) + m is of degree l and order m; degree 1 is y, z, x. No phase factors: all of degree
// 1 are positive along their axis.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "base/frame.hpp"

namespace relumine {

inline constexpr int most_bands = 16;

constexpr std::size_t harmonic_count(int bands) {
    return static_cast<std::size_t>(bands) * static_cast<std::size_t>(bands);
}
constexpr std::size_t harmonic_index(int l, int m) { return static_cast<std::size_t>(l * (l + 1) + m); }

/// One value per harmonic of `bands` bands.
using HarmonicValues = std::array<float, harmonic_count(most_bands)>;

/// The orthonormal harmonics of degrees below `bands` in a direction.
void evaluate_harmonics(int bands, Vec3 direction, HarmonicValues& values);

/// The factors of them that depend on the polar angle alone: harmonic (l, m) is value l (l + 1) + |m| times
/// cos mφ for m ≥ 0, times sin |m|φ for m < 0.
void evaluate_polar_factors(int bands, float cosine, HarmonicValues& values);

/// How coefficients change when what they stand for is turned from a frame's own axes into the frame
/// [Ivanic96].
class HarmonicRotation {
  public:
    /// `frame` in the space that coefficients are turned into.
    HarmonicRotation(int bands, const Frame& frame);

    /// turned = R · coefficients, harmonic_count(bands) of each; not the same.
    void turn(std::span<const float> coefficients, std::span<float> turned) const;

  private:
    [[nodiscard]] float at(int l, int m, int n) const;
    [[nodiscard]] float product(int i, int l, int m, int n) const;
    [[nodiscard]] float element(int l, int m, int n) const;

    int bands_;
    std::vector<float> matrices_;  // band after band, (2l + 1)² each, row-major
};

}  // namespace relumine
