// SPDX-License-Identifier: Apache-2.0
// Pixel filters: positions follow the filter's shape.
#include "integrators/pixel_filter.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "base/sample_stream.hpp"
#include "tests/statistics.hpp"

namespace relumine {
namespace {

double window(double x) {  // four-term Blackman-Harris over [−1.5, 1.5]
    const double phi = 2 * 3.14159265358979 * (x + 1.5) / 3;
    return 0.35875 - 0.48829 * std::cos(phi) + 0.14128 * std::cos(2 * phi) - 0.01168 * std::cos(3 * phi);
}

/// χ² of positions along x over 60 cells of 3 pixels, against the window.
double filter_p(const PixelFilter& filter) {
    constexpr int cells = 60, fine = 50, draws = 200'000;
    std::vector<double> observed(cells), expected(cells);
    double total = 0;
    for (int i = 0; i < cells * fine; ++i) total += window(-1.5 + 3 * (i + 0.5) / (cells * fine));
    for (int i = 0; i < cells * fine; ++i)
        expected[static_cast<std::size_t>(i / fine)] +=
            draws * window(-1.5 + 3 * (i + 0.5) / (cells * fine)) / total;
    for (std::uint32_t i = 0; i < draws; ++i) {
        const double x =
            filter.position(SampleStream{1, i, 1, PointSet::independent}.next2(Dim::pixel)).x - 0.5;
        ++observed[static_cast<std::size_t>(
            std::clamp(static_cast<int>((x + 1.5) / 3 * cells), 0, cells - 1))];
    }
    return testing::chi_square_p(observed, expected);
}

TEST(PixelFilter, BlackmanHarrisFollowsItsWindow) {
    EXPECT_GT(filter_p(PixelFilter(PixelFilterKind::blackman_harris)), 1e-6);
    EXPECT_LT(filter_p(PixelFilter(PixelFilterKind::box)), 1e-6);  // another filter must be caught
}

TEST(PixelFilter, BoxAndCenterStayInThePixel) {
    EXPECT_EQ(PixelFilter(PixelFilterKind::center).position({0.1f, 0.9f}), (Point2{0.5f, 0.5f}));
    EXPECT_EQ(PixelFilter(PixelFilterKind::box).position({0.1f, 0.9f}), (Point2{0.1f, 0.9f}));
}

}  // namespace
}  // namespace relumine
