// SPDX-License-Identifier: Apache-2.0
// Errors of one picture against another, pixel by pixel and in the means of blocks.
#include "film/compare.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "relumine/compare.hpp"

namespace relumine {
namespace {

using namespace compare;

/// The value below which a share `q` of the values lies, interpolated between neighbours; 0 of nothing.
double quantile(std::vector<double> values, double q) {
    if (values.empty()) return 0;
    std::ranges::sort(values);
    const double position = q * static_cast<double>(values.size() - 1);
    const auto below = static_cast<std::size_t>(position);
    const std::size_t above = std::min(below + 1, values.size() - 1);
    return std::lerp(values[below], values[above], position - static_cast<double>(below));
}

/// Sums over the pixels that are finite in both pictures.
struct Totals {
    double l1 = 0, square = 0, relative_square = 0, image = 0, reference = 0, largest = 0;
    std::size_t pixels = 0, non_finite = 0;

    void add_pixel(const Rgb& l, const Rgb& l_ref) {
        constexpr double epsilon = 0.01;  // radiance²: the usual guard of relMSE
        ++pixels;
        for (std::size_t c = 0; c < 3; ++c) {
            const double difference = l[c] - l_ref[c];
            l1 += std::abs(difference);
            square += difference * difference;
            relative_square += difference * difference / (l_ref[c] * l_ref[c] + epsilon);
            image += l[c];
            reference += l_ref[c];
            largest = std::max(largest, std::abs(difference));
        }
    }
};

Comparison metrics(const Totals& totals) {
    Comparison result;
    result.compared_pixels = totals.pixels;
    result.non_finite_pixels = totals.non_finite;
    const double values = std::max(1.0, 3 * static_cast<double>(totals.pixels));
    result.relative_l1 = ratio(totals.l1, totals.reference);
    result.rmse = std::sqrt(totals.square / values);
    result.relmse = totals.relative_square / values;
    result.mean_ratio = ratio(totals.image, totals.reference, 1);
    result.max_abs_difference = totals.largest;
    return result;
}

/// Mean colours of a block in both pictures, over the pixels that are finite in both.
struct Block {
    Rgb image{}, reference{};
    double pixels = 0;
};

Block sum_block(const Picture& image, const Picture& reference, const PixelRect& rect, Totals& totals) {
    Block block;
    for (int y = rect.y0; y < rect.y1; ++y)
        for (int x = rect.x0; x < rect.x1; ++x) {
            const Rgb l = image.at(x, y), l_ref = reference.at(x, y);
            if (!is_finite(l) || !is_finite(l_ref)) {
                ++totals.non_finite;
                continue;
            }
            totals.add_pixel(l, l_ref);
            add(block.image, l);
            add(block.reference, l_ref);
            ++block.pixels;
        }
    return block;
}

std::vector<PixelRect> blocks_of(int width, int height, int size) {
    std::vector<PixelRect> blocks;
    for (int y = 0; y < height; y += std::min(size, height - y))
        for (int x = 0; x < width; x += std::min(size, width - x))
            blocks.push_back({x, y, x + std::min(size, width - x), y + std::min(size, height - y)});
    return blocks;
}

void add_blocks(Comparison& result, const std::vector<Block>& blocks, const std::vector<PixelRect>& rects,
                const Totals& totals, double tolerance) {
    const double floor = dark * ratio(totals.reference, static_cast<double>(totals.pixels));
    std::vector<double> differences;
    for (std::size_t i = 0; i < blocks.size(); ++i) {
        const Block& block = blocks[i];
        if (block.pixels == 0) continue;
        const double per_pixel = 1 / block.pixels;
        differences.push_back(
            block_difference(scaled(block.image, per_pixel), scaled(block.reference, per_pixel), floor));
        if (differences.size() > 1 && differences.back() <= result.block_difference_max) continue;
        result.block_difference_max = differences.back();
        result.worst_block = rects[i];
    }
    result.blocks = differences.size();
    result.block_difference_median = quantile(differences, 0.5);
    result.block_difference_p95 = quantile(differences, 0.95);
    const auto within = std::ranges::count_if(differences, [&](double d) { return d <= tolerance; });
    if (result.blocks > 0)
        result.blocks_within_tolerance = static_cast<double>(within) / static_cast<double>(result.blocks);
}

}  // namespace

Comparison compare_images(const Image& image, const Image& reference, const CompareOptions& options) {
    check(options.block_size >= 1, "block size", "at least 1 pixel", options.block_size);
    check(options.block_tolerance >= 0, "block tolerance", "a number of at least 0", options.block_tolerance);
    const Picture picture(image, "image"), reference_picture(reference, "reference");
    check_same_size(picture, reference_picture, "image");
    const std::vector<PixelRect> rects = blocks_of(image.width, image.height, options.block_size);
    Totals totals;
    std::vector<Block> blocks;
    blocks.reserve(rects.size());
    for (const PixelRect& rect : rects) blocks.push_back(sum_block(picture, reference_picture, rect, totals));
    Comparison result = metrics(totals);
    add_blocks(result, blocks, rects, totals, options.block_tolerance);
    return result;
}

}  // namespace relumine
