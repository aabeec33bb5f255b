// SPDX-License-Identifier: Apache-2.0
// Stored references: the mean and the deviation of samples, and tests of a picture against them.
#pragma once

#include <string>
#include <vector>

#include "relumine/image.hpp"
#include "tests/pictures/cases.hpp"

namespace relumine::pictures {

/// A picture that many samples agree on.
struct Reference {
    Image mean;
    std::vector<float> deviation;  // of a single camera sample; width × height × 3
    double samples = 0;            // behind the mean, per pixel
};

/// Seeds are at least this much: the test's own seed is 0, so its samples are others.
inline constexpr std::uint64_t first_reference_seed = 1000;
inline constexpr int reference_batches = 64;

/// Renders `samples` camera samples per pixel with `path`, in batches of different seeds whose scatter gives
/// the deviation.
[[nodiscard]] Reference make_reference(const PictureCase& picture, int samples);

[[nodiscard]] std::string reference_path(const PictureCase& picture);
void write_reference(const Reference& reference, const std::string& path);
[[nodiscard]] Reference read_reference(const std::string& path);

/// How a picture of `samples` independent camera samples per pixel fits a reference.
struct Fit {
    double p = 1;           // of the worst comparison, corrected for their number (Šidák)
    double worst_z = 0;     // of blocks of 4 × 4 pixels and of the picture, each channel
    double mean_z = 0;      // of the picture's mean, the worst channel
    double mean_error = 0;  // standard error of the picture's mean relative to it, all channels
};
[[nodiscard]] Fit fit(const Image& image, double samples, const Reference& reference);

}  // namespace relumine::pictures
