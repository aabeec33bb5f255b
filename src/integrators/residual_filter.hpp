// SPDX-License-Identifier: Apache-2.0
// Smoothing what few rays have estimated, along surfaces: the edge-avoiding à-trous wavelet [Dammertz10].
#pragma once

#include <cstdint>
#include <vector>

#include "base/frame.hpp"

namespace relumine {

/// What a pixel shows, for telling surfaces apart.
struct FilterGuide {
    Vec3 position, normal;
    float footprint = 0;         // metres that a pixel covers; 0: nothing to filter here
    std::uint32_t material = 0;  // what is of different ones is never mixed
    int contact = 0;             // pixels to where another surface rises from this one; see find_contacts
};

/// A picture under the filter, row-major.
struct FilterImage {
    int width = 0, height = 0;
    std::vector<FilterGuide> guides;
    std::vector<Spectrum> values;
    std::vector<Spectrum> weights;  // that values have in means; empty: all the same
};

/// Contacts are looked for so far away, pixels; farther ones, and none, count as one more.
inline constexpr int contact_reach = 4;

/// Gives all guides their distances to contacts: corners of rooms, feet of things, as the picture shows them.
/// What maps get wrong there is as narrow as a pixel or two, and far more than around.
void find_contacts(FilterImage& image, int threads);

/// How far a filter of so many levels reaches, pixels.
constexpr int filter_reach(int levels) { return 2 * ((1 << levels) - 1); }

/// Replaces every value by a mean over its surroundings on the same surface, up to filter_reach(levels)
/// away.
void filter_along_surfaces(FilterImage& image, int levels, int threads);

/// Turns the variances of values that are independent from pixel to pixel into those after
/// filter_along_surfaces. From the second level on values are no longer independent: how much more remains
/// than if they were is taken from an open plane.
void filter_variances(FilterImage& variances, int levels, int threads);

/// The parts of noisy values that are to be smoothed alike.
using FilterParts = std::vector<std::vector<Spectrum>>;

/// filter_along_surfaces of several layers of values, for the guides of one picture.
void filter_along_surfaces(const FilterImage& guides, FilterParts& parts, int levels, int threads);
/// The same, and filter_variances of others.
void filter_along_surfaces(const FilterImage& guides, FilterParts& parts, FilterParts& variances, int levels,
                           int threads);

/// Of noise, by pixel, of the luminance of all parts together.
struct NoiseVariances {
    std::vector<float> expected, cautious;  // as far as is known, and what it may well be
};

/// Smooths what may be noise and keeps what is more: level by level, a pixel's difference to its surroundings
/// stays by the share of it, over the pixels around, that noise does not explain, cautiously estimated
/// (Wiener's filter on the wavelet's details). `guides` may have weights: Σ weight · value is then what a
/// mean keeps. Returns the error that is left, a variance by pixel: noise, and details taken for it.
[[nodiscard]] std::vector<float> smooth_noise(FilterImage guides, FilterParts& parts,
                                              const NoiseVariances& variances, int levels, int threads);

/// What smooth_noise holds for each pixel beside its arguments, of so many parts: these, their details, and
/// what of them is kept; weights, noise and its weights, and the energy of details, before a level and after.
constexpr std::size_t smoothing_bytes(std::size_t parts) {
    return (8 + 3 * parts) * sizeof(Spectrum) + sizeof(float);
}

/// Levels of the filter over which squares of noise are averaged: fewer values scatter too much themselves.
inline constexpr int noise_levels = 2;

/// How far away the pixels are that find_contacts and smooth_noise take into account.
constexpr int smoothing_reach(int levels) {
    return filter_reach(levels) + filter_reach(noise_levels) + contact_reach;
}

}  // namespace relumine
