// SPDX-License-Identifier: Apache-2.0
// Predicted errors against values worked out by hand.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "relumine/compare.hpp"
#include "relumine/error.hpp"

namespace relumine {
namespace {

Image picture(std::vector<float> pixels, std::vector<float> errors) {
    const int width = static_cast<int>(pixels.size());
    Image image{width, 1, {0, 0, width, 1}, width, 1, {{"", {"Y"}, std::move(pixels)}}, {}};
    if (!errors.empty()) image.layers.push_back({"error", {"Y"}, std::move(errors)});
    return image;
}

TEST(ErrorCoverage, IsNotThereWithoutTheLayer) {
    const Image image = picture({1, 2}, {});
    EXPECT_FALSE(predicted_relative_l1(image));
    EXPECT_FALSE(error_coverage(image, image));
}

TEST(ErrorCoverage, ExpectsTheMeanOfNormalErrors) {  // √(2/π) σ
    EXPECT_NEAR(*predicted_relative_l1(picture({1, 3}, {0.1f, 0.02f})),
                std::sqrt(2 / std::numbers::pi) * (0.1 + 0.06) / 4, 1e-7);
    EXPECT_EQ(*predicted_relative_l1(picture({0, 0}, {0, 0})), 0);
}

TEST(ErrorCoverage, CountsPixelsThatHaveAPrediction) {
    constexpr float nan = std::numeric_limits<float>::quiet_NaN();
    const Image image = picture({1, 1, 1, 1, 1, nan}, {0.1f, 0.1f, 0.1f, 0.1f, 0, 0.1f});
    const Image reference = picture({1.05f, 0.85f, 1.3f, 0.99f, 7, 1}, {});
    const ErrorCoverage coverage = *error_coverage(image, reference);
    EXPECT_EQ(coverage.pixels, 4u);
    EXPECT_DOUBLE_EQ(coverage.one_sigma, 0.5);
    EXPECT_DOUBLE_EQ(coverage.two_sigma, 0.75);
    EXPECT_THROW((void)error_coverage(image, picture({1}, {})), ImageError);
}

TEST(ErrorCoverage, AddsTheReferencesOwnError) {
    const Image image = picture({1}, {0.03f});
    EXPECT_EQ(error_coverage(image, picture({1.045f}, {}))->one_sigma, 0);
    EXPECT_EQ(error_coverage(image, picture({1.045f}, {0.04f}))->one_sigma, 1);
}

}  // namespace
}  // namespace relumine
