// SPDX-License-Identifier: Apache-2.0
// FLIP against the values of its authors' implementation, and what must hold of any difference.
#include <gtest/gtest.h>

#include <cmath>

#include "relumine/compare.hpp"
#include "relumine/error.hpp"

namespace relumine {
namespace {

template <typename F>
Image picture(F colour, int width = 48, int height = 32) {
    Image image;
    image.width = width;
    image.height = height;
    Layer& layer = image.layers.emplace_back(Layer{"", {"R", "G", "B"}, {}});
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const std::array<double, 3> c = colour(x, y);
            for (const double value : c) layer.pixels.push_back(static_cast<float>(value));
        }
    return image;
}

std::array<double, 3> ramp(int x, int y) { return {x / 47.0, y / 31.0, 0.3}; }
std::array<double, 3> stripes(int x, int y) { return {x / 47.0, (x + y) % 2 * 0.8, 0.3}; }
std::array<double, 3> step(int x, int y) {
    return {x < 20 ? 0.1 : 0.9, y < 10 ? 0.5 : 0.2, x < 20 ? 0.1 : 0.4};
}

/// flip-evaluator 1.7, LDR, 67 pixels per degree, of the same linear values.
TEST(Flip, IsThatOfItsAuthors) {
    EXPECT_NEAR(flip(picture(ramp), picture(stripes)).mean, 0.72619, 1e-4);
    EXPECT_NEAR(flip(picture(ramp), picture(step)).mean, 0.87851, 1e-4);
    EXPECT_NEAR(flip(picture(step), picture(stripes)).mean, 0.64819, 1e-4);
    const auto brighter = [](int x, int y) {
        auto c = step(x, y);
        for (double& value : c) value *= 1.02;
        return c;
    };
    EXPECT_NEAR(flip(picture(brighter), picture(step)).mean, 0.05786, 1e-4);
}

TEST(Flip, IsZeroOfTheSameAndSymmetric) {
    EXPECT_EQ(flip(picture(ramp), picture(ramp)).mean, 0);
    const Flip there = flip(picture(ramp), picture(step)), back = flip(picture(step), picture(ramp));
    EXPECT_NEAR(there.mean, back.mean, 1e-12);
    for (const float value : there.pixels) {
        ASSERT_GE(value, 0);
        ASSERT_LE(value, 1);
    }
}

TEST(Flip, ExposureBringsOutWhatIsDark) {
    const auto dark = [](int x, int y) { return std::array{0.001 * (x % 7), 0.001, 0.001 * (y % 3)}; };
    const auto darker = [](int, int) { return std::array{0.0, 0.0, 0.0}; };
    const double plain = flip(picture(dark), picture(darker)).mean;
    EXPECT_GT(flip(picture(dark), picture(darker), {.exposure = 7}).mean, 3 * plain);
}

TEST(Flip, RefusesOtherSizesAndBadOptions) {
    EXPECT_THROW((void)flip(picture(ramp), picture(ramp, 47, 32)), ImageError);
    EXPECT_THROW((void)flip(picture(ramp), picture(ramp), {.exposure = NAN}), SettingsError);
    EXPECT_THROW((void)flip(picture(ramp), picture(ramp), {.exposure = 0, .pixels_per_degree = 0}),
                 SettingsError);
}

}  // namespace
}  // namespace relumine
