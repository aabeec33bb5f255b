// SPDX-License-Identifier: Apache-2.0
// Agreement of a picture with a reference that consists of block means and their standard errors.
#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "film/compare.hpp"
#include "relumine/compare.hpp"

namespace relumine {
namespace {

using namespace compare;

/// Everything that `compare_blocks` was given, with the sizes checked.
struct BlockInput {
    Picture image, reference;
    std::optional<Picture> reference_error, variance;
    int block_size = 0;  // pixels a side
};

int checked_block_size(const Picture& image, const Picture& reference) {
    const int size = image.width() / reference.width();
    if (size >= 1 && size * reference.width() == image.width() && size * reference.height() == image.height())
        return size;
    throw ImageError{expected_found(
        "image",
        "a multiple of " + size_text(reference.width(), reference.height()) + ", the reference's block means",
        size_text(image.width(), image.height()))};
}

BlockInput checked_input(const Image& image, const Image& reference, const Image* reference_error,
                         const Image* variance) {
    BlockInput input{Picture(image, "image"), Picture(reference, "reference"), {}, {}, 0};
    input.block_size = checked_block_size(input.image, input.reference);
    if (reference_error) {
        input.reference_error.emplace(*reference_error, "standard error of the reference");
        check_same_size(*input.reference_error, input.reference, "standard error of the reference");
    }
    if (variance) {
        input.variance.emplace(*variance, "variance of the image");
        check_same_size(*input.variance, input.image, "variance of the image");
    }
    return input;
}

struct BlockMean {
    Rgb mean{};
    Rgb variance{};  // of that mean
    std::size_t non_finite = 0;
};

/// Independent pixels: the variance of a mean of n is the sum of theirs over n².
BlockMean mean_of_block(const BlockInput& input, int column, int row) {
    const int size = input.block_size;
    const double pixels = static_cast<double>(size) * size;
    BlockMean block;
    for (int y = row * size; y < (row + 1) * size; ++y)
        for (int x = column * size; x < (column + 1) * size; ++x) {
            const Rgb value = input.image.at(x, y);
            const Rgb variance = input.variance ? input.variance->at(x, y) : Rgb{};
            if (!is_finite(value) || !is_finite(variance) || std::ranges::min(variance) < 0)
                ++block.non_finite;
            add(block.mean, value, 1 / pixels);
            add(block.variance, variance, 1 / (pixels * pixels));
        }
    return block;
}

bool is_bright(const BlockInput& input, int column, int row, double limit) {
    if (column < 0 || row < 0 || column >= input.reference.width() || row >= input.reference.height())
        return false;
    return std::ranges::max(input.reference.at(column, row)) > limit;
}

/// Whether the block or one of its 8 neighbours is brighter than `limit`.
bool near_bright(const BlockInput& input, int column, int row, double limit) {
    for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx)
            if (is_bright(input, column + dx, row + dy, limit)) return true;
    return false;
}

bool is_included(const BlockInput& input, int column, int row, const BlockTolerance& tolerance) {
    const Rgb error = input.reference_error ? input.reference_error->at(column, row) : Rgb{};
    if (!is_finite(input.reference.at(column, row)) || !is_finite(error)) return false;
    return !tolerance.exclude_above || !near_bright(input, column, row, *tolerance.exclude_above);
}

/// 5 % of the mean brightness of the reference's finite blocks.
double block_floor(const Picture& reference) {
    double total = 0, count = 0;
    for (int y = 0; y < reference.height(); ++y)
        for (int x = 0; x < reference.width(); ++x)
            if (const Rgb mean = reference.at(x, y); is_finite(mean)) {
                total += sum(mean);
                ++count;
            }
    return dark * ratio(total, count);
}

/// Gathers the verdicts on single blocks.
class BlockJudge {
  public:
    BlockJudge(const BlockInput& input, const BlockTolerance& tolerance)
        : input_(input), tolerance_(tolerance), floor_(block_floor(input.reference)) {
        result_.block_size = input.block_size;
        result_.columns = input.reference.width();
        result_.rows = input.reference.height();
    }
    void judge(int column, int row) {
        result_.of_allowed.push_back(-1);
        if (!is_included(input_, column, row, tolerance_)) {
            ++result_.excluded;
            return;
        }
        ++result_.included;
        const BlockMean block = mean_of_block(input_, column, row);
        result_.non_finite_pixels += block.non_finite;
        const double of_allowed = block.non_finite > 0 ? infinite : judge_finite(block, column, row);
        result_.of_allowed.back() = static_cast<float>(of_allowed);
        if (of_allowed > 1) ++result_.failing;
    }
    [[nodiscard]] BlockComparison result() const {
        BlockComparison done = result_;
        done.mean_ratio = ratio(image_sum_, reference_sum_, 1);
        done.mean_relative_difference = ratio(relative_sum_, finite_blocks_);
        return done;
    }

  private:
    double judge_finite(const BlockMean& block, int column, int row) {
        const Rgb reference = input_.reference.at(column, row);
        const double relative = block_difference(block.mean, reference, floor_);
        ++finite_blocks_;
        image_sum_ += sum(block.mean);
        reference_sum_ += sum(reference);
        relative_sum_ += relative;
        result_.max_relative_difference = std::max(result_.max_relative_difference, relative);
        double worst = 0;
        for (std::size_t c = 0; c < 3; ++c) worst = std::max(worst, judge_channel(block, column, row, c));
        return worst;
    }
    double judge_channel(const BlockMean& block, int column, int row, std::size_t c) {
        const double reference = input_.reference.at(column, row)[c];
        const double reference_error =
            input_.reference_error ? input_.reference_error->at(column, row)[c] : 0;
        const double combined = std::sqrt(block.variance[c] + reference_error * reference_error);
        const double difference = std::abs(block.mean[c] - reference);
        const double allowed = tolerance_.sigmas * combined + tolerance_.relative * std::abs(reference);
        const double of_allowed = ratio(difference, allowed);
        if (of_allowed > result_.worst_of_allowed) {
            result_.worst_of_allowed = of_allowed;
            result_.worst_column = column;
            result_.worst_row = row;
            result_.worst_channel = static_cast<int>(c);
            result_.worst_sigmas = ratio(difference, combined);
        }
        return of_allowed;
    }

    const BlockInput& input_;
    const BlockTolerance& tolerance_;
    double floor_;
    BlockComparison result_;
    double image_sum_ = 0, reference_sum_ = 0, relative_sum_ = 0, finite_blocks_ = 0;
};

}  // namespace

BlockComparison compare_blocks(const Image& image, const Image& reference_block_means,
                               const BlockTolerance& tolerance, const Image* reference_standard_error,
                               const Image* image_variance) {
    check(tolerance.sigmas >= 0, "sigmas", "a number of at least 0", tolerance.sigmas);
    check(tolerance.relative >= 0, "relative tolerance", "a number of at least 0", tolerance.relative);
    const BlockInput input =
        checked_input(image, reference_block_means, reference_standard_error, image_variance);
    BlockJudge judge(input, tolerance);
    for (int row = 0; row < reference_block_means.height; ++row)
        for (int column = 0; column < reference_block_means.width; ++column) judge.judge(column, row);
    return judge.result();
}

}  // namespace relumine
