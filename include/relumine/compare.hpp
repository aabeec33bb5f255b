// SPDX-License-Identifier: Apache-2.0
// How far two pictures are apart: errors over all pixels, agreement of block means, a picture of the
// difference.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "relumine/image.hpp"

namespace relumine {

struct CompareOptions {
    int block_size = 16;            // pixels a side; blocks at the right and lower edge may be smaller
    double block_tolerance = 0.02;  // for `blocks_within_tolerance`: relative difference of block means
};

/// How two pictures differ; L is the image, Lref the reference, in linear RGB. Sums run over pixels and
/// channels. A ratio x / 0 is 0 where x is 0 too, else infinite; `mean_ratio` is 1 where both sums are 0.
struct Comparison {
    std::size_t compared_pixels = 0;
    std::size_t non_finite_pixels = 0;  // NaN or ±∞ in either picture: left out of everything below

    double relative_l1 = 0;         // Σ|L − Lref| / Σ Lref
    double rmse = 0;                // √(mean of (L − Lref)²), in units of radiance
    double relmse = 0;              // mean of (L − Lref)² / (Lref² + 0.01)
    double mean_ratio = 1;          // Σ L / Σ Lref
    double max_abs_difference = 0;  // in units of radiance

    // Blocks compare the mean colours m and mref of block_size² pixels: Σ|m − mref| / max(Σ mref, 5 % of the
    // mean Σ mref of the picture), Σ over channels.
    std::size_t blocks = 0;
    double block_difference_median = 0, block_difference_p95 = 0, block_difference_max = 0;
    double blocks_within_tolerance = 1;  // share in [0, 1] of blocks with a difference ≤ block_tolerance
    PixelRect worst_block;               // counts from the stored pixels' corner

    [[nodiscard]] bool all_finite() const { return non_finite_pixels == 0; }
};

/// Throws ImageError when the sizes differ or a file has no picture itself, SettingsError for a bad option.
[[nodiscard]] Comparison compare_images(const Image& image, const Image& reference,
                                        const CompareOptions& options = {});

/// The relative L1 error that a picture's layer "error" expects if errors are normal: √(2/π) Σ σ L / Σ L over
/// luminance L and what the layer says, σ. Empty where there is no such layer.
[[nodiscard]] std::optional<double> predicted_relative_l1(const Image& image);

/// How often the layer "error" was right, over the pixels that it says something of.
struct ErrorCoverage {
    std::size_t pixels = 0;
    double one_sigma = 1, two_sigma = 1;  // share of them whose luminance is so near to the reference's
};

/// Empty where the image has no such layer. A reference that has one, too, adds its own error. Throws
/// ImageError when the sizes differ or a picture itself is missing.
[[nodiscard]] std::optional<ErrorCoverage> error_coverage(const Image& image, const Image& reference);

/// What `compare_blocks` lets pass: |difference| ≤ sigmas × combined standard error + relative × reference.
struct BlockTolerance {
    double sigmas = 4;
    double relative = 0.01;
    std::optional<double> exclude_above =
        std::nullopt;  // leave out blocks whose reference, in any channel, exceeds this
                       // radiance (they show a light source), and their 8 neighbours
};

/// How the block means of a picture agree with a reference that consists of block means.
struct BlockComparison {
    int block_size = 0;         // pixels a side
    int columns = 0, rows = 0;  // of blocks
    std::size_t included = 0;   // blocks
    std::size_t excluded = 0;   // blocks left out by `exclude_above`, or whose reference is not finite
    std::size_t failing = 0;    // included blocks out of tolerance in a channel, or with non-finite pixels
    std::size_t non_finite_pixels = 0;  // of the image, in included blocks

    // Over the included blocks without non-finite pixels:
    double mean_ratio = 1;                // Σ m / Σ mref
    double mean_relative_difference = 0;  // mean of Σ|m − mref| / max(Σ mref, 5 % of the mean Σ mref)
    double max_relative_difference = 0;
    double worst_of_allowed = 0;  // largest |difference| / allowed difference of a channel; > 1 fails
    int worst_column = 0, worst_row = 0, worst_channel = 0;  // where; channel 0, 1, 2: R, G, B
    double worst_sigmas = 0;  // there: |difference| in combined standard errors; infinite where that is 0
    std::vector<float> of_allowed;  // columns × rows: the same of each block's worst channel; −1 where left
                                    // out, infinite where pixels are not finite

    [[nodiscard]] bool passes() const { return failing == 0 && included > 0; }
};

/// Compares with a `columns × rows` picture of block means. The image must be k times as wide and as high, k
/// ≥ 1. `reference_standard_error`: of the reference's means, of the same size. `image_variance`: of the mean
/// of each pixel of the image, in radiance². Where one is null, that side counts as exact. Throws ImageError
/// when sizes do not fit or a picture itself is missing, SettingsError for a bad tolerance.
[[nodiscard]] BlockComparison compare_blocks(const Image& image, const Image& reference_block_means,
                                             const BlockTolerance& tolerance = {},
                                             const Image* reference_standard_error = nullptr,
                                             const Image* image_variance = nullptr);

/// How pictures are shown and looked at.
struct FlipOptions {
    double exposure = 0;            // stops; then radiance is cut to [0, 1]
    double pixels_per_degree = 67;  // of the eye: a 4K screen of 0.7 m seen from 0.7 m
};

/// The difference that a viewer sees who alternates between two pictures: 0 none, 1 the most [Andersson20].
struct Flip {
    double mean = 0;
    std::vector<float> pixels;  // width × height, top row first
};

/// Throws ImageError when the sizes differ or a picture itself is missing, SettingsError for a bad option.
/// NaN counts as black.
[[nodiscard]] Flip flip(const Image& image, const Image& reference, const FlipOptions& options = {});

/// A picture of the signed difference of luminance: red where the image is brighter, blue where it is darker,
/// white where they agree, green where a pixel is not finite. Full colour means ±`scale`; `scale` ≤ 0 takes
/// the 99th percentile of |difference|. The scale used stands in the metadata as "difference_scale". Throws
/// ImageError when the sizes differ or a picture itself is missing, SettingsError when `scale` is not finite.
[[nodiscard]] Image signed_difference(const Image& image, const Image& reference, double scale = 0);

}  // namespace relumine
