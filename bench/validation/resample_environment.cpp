// SPDX-License-Identifier: Apache-2.0
// Rewrites a lat-long environment so that our lookup of the result is Mitsuba's lookup of the original.
#include <algorithm>
#include <cstdio>
#include <exception>
#include <utility>

#include "relumine/image.hpp"

namespace {

/// Of the result: its linear interpolation rounds off the kinks between rows by 0.01 % (0.2 % with 4).
constexpr int rows_per_row = 16;

/// Of H rows, Mitsuba 3 puts the first at v = 0 and the last at v = 1: row coordinate v · (H − 1). We put row
/// j at v = (j + ½) / H, as both do with columns.
relumine::Image resampled(const relumine::Image& source) {
    const int width = source.width, height = rows_per_row * source.height;
    relumine::Layer layer{"", {"R", "G", "B"}, {}};
    layer.pixels.reserve(3 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    for (int row = 0; row < height; ++row) {
        const double v = (row + 0.5) / height;
        const double y = v * (source.height - 1);
        const int above = std::min(static_cast<int>(y), source.height - 1);
        const int below = std::min(above + 1, source.height - 1);
        const auto t = static_cast<float>(y - above);
        for (int x = 0; x < width; ++x) {
            const auto a = source.rgb(x, above), b = source.rgb(x, below);
            for (std::size_t c = 0; c < 3; ++c) layer.pixels.push_back((1 - t) * a[c] + t * b[c]);
        }
    }
    return {width, height, {0, 0, width, height}, width, height, {std::move(layer)}, {}};
}

}  // namespace

int main(int argc, char** argv) try {
    if (argc != 3) {
        std::fprintf(stderr, "usage: relumine_resample_environment SOURCE.exr RESULT.pfm\n");
        return 2;
    }
    relumine::write_image(resampled(relumine::read_image(argv[1])), argv[2]);
    return 0;
} catch (const std::exception& error) {
    std::fprintf(stderr, "relumine_resample_environment: %s\n", error.what());
    return 1;
}
