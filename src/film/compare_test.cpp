// SPDX-License-Identifier: Apache-2.0
// Comparisons against values worked out by hand.
#include "relumine/compare.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "relumine/error.hpp"

namespace relumine {
namespace {

constexpr float not_a_number = std::numeric_limits<float>::quiet_NaN();
constexpr float inf = std::numeric_limits<float>::infinity();

Image grey(int width, int height, std::vector<float> pixels) {
    return {width, height, {0, 0, width, height}, width, height, {{"", {"Y"}, std::move(pixels)}}, {}};
}
Image even(int width, int height, float value) {
    return grey(width, height, std::vector<float>(static_cast<std::size_t>(width * height), value));
}
Image colours(int width, int height, std::vector<float> pixels) {
    return {width, height, {0, 0, width, height}, width, height, {{"", {"R", "G", "B"}, std::move(pixels)}},
            {}};
}
float& at(Image& image, int x, int y) {
    return image.layers[0].pixels[static_cast<std::size_t>(y * image.width + x)];
}

TEST(CompareImages, APictureAgreesWithItself) {
    const Image image = colours(2, 1, {1, 2, 3, 0, 0, 7});
    const Comparison result = compare_images(image, image);
    EXPECT_EQ(result.compared_pixels, 2u);
    EXPECT_EQ(result.relative_l1, 0);
    EXPECT_EQ(result.rmse, 0);
    EXPECT_EQ(result.relmse, 0);
    EXPECT_EQ(result.mean_ratio, 1);
    EXPECT_EQ(result.block_difference_max, 0);
    EXPECT_EQ(result.blocks_within_tolerance, 1);
    EXPECT_TRUE(result.all_finite());
}

TEST(CompareImages, MetricsMatchHandComputedValues) {
    const Image image = colours(2, 1, {1, 2, 3, 4, 5, 6}), reference = colours(2, 1, {2, 2, 2, 4, 4, 4});
    const Comparison result = compare_images(image, reference);
    EXPECT_DOUBLE_EQ(result.relative_l1, (1 + 0 + 1 + 0 + 1 + 2) / 18.0);
    EXPECT_DOUBLE_EQ(result.rmse, std::sqrt((1 + 0 + 1 + 0 + 1 + 4) / 6.0));
    EXPECT_DOUBLE_EQ(result.relmse, (1 / 4.01 + 0 + 1 / 4.01 + 0 + 1 / 16.01 + 4 / 16.01) / 6);
    EXPECT_DOUBLE_EQ(result.mean_ratio, 21 / 18.0);
    EXPECT_DOUBLE_EQ(result.max_abs_difference, 2);
}

TEST(CompareImages, BlackReferencesGiveNoNaN) {
    const Comparison black = compare_images(even(2, 2, 0), even(2, 2, 0));
    EXPECT_EQ(black.relative_l1, 0);
    EXPECT_EQ(black.mean_ratio, 1);
    EXPECT_EQ(black.block_difference_max, 0);
    const Comparison light = compare_images(even(2, 2, 1), even(2, 2, 0));
    EXPECT_EQ(light.relative_l1, inf);
    EXPECT_EQ(light.mean_ratio, inf);
    EXPECT_EQ(light.block_difference_max, inf);
    EXPECT_DOUBLE_EQ(light.relmse, 100);
}

TEST(CompareImages, BlocksReportMedianPercentileAndWorst) {
    // 5 × 1 blocks of 2 × 2 pixels around 1, with differences 0, 0.1, 0.2, 0.3, 1; noise inside a block
    // averages out
    const Image reference = even(10, 2, 1);
    Image image = reference;
    for (int block = 0; block < 5; ++block)
        for (int y = 0; y < 2; ++y)
            for (int x = 0; x < 2; ++x)
                at(image, 2 * block + x, y) =
                    1 + (block == 4 ? -1.0f : 0.1f * static_cast<float>(block)) + (x == y ? 0.5f : -0.5f);
    const Comparison result = compare_images(image, reference, {.block_size = 2, .block_tolerance = 0.25});
    EXPECT_EQ(result.blocks, 5u);
    EXPECT_NEAR(result.block_difference_median, 0.2, 1e-7);
    EXPECT_NEAR(result.block_difference_p95, 0.3 + 0.8 * 0.7, 1e-7);  // at position 3.8 of 0…4
    EXPECT_NEAR(result.block_difference_max, 1, 1e-7);
    EXPECT_EQ(result.worst_block, (PixelRect{8, 0, 10, 2}));
    EXPECT_DOUBLE_EQ(result.blocks_within_tolerance, 3 / 5.0);
}

TEST(CompareImages, DarkBlocksAreMeasuredAgainstFivePercentOfTheMean) {
    const Image reference = grey(2, 1, {0, 2}), image = grey(2, 1, {0.01f, 2});  // mean 1
    EXPECT_NEAR(compare_images(image, reference, {.block_size = 1}).block_difference_max, 0.01 / 0.05, 1e-6);
}

TEST(CompareImages, ColoursOfABlockDoNotCancel) {
    const Comparison result = compare_images(colours(1, 1, {2, 1, 0}), colours(1, 1, {1, 1, 1}));
    EXPECT_DOUBLE_EQ(result.block_difference_max, 2 / 3.0);
    EXPECT_DOUBLE_EQ(result.mean_ratio, 1);
}

TEST(CompareImages, BlocksAtTheEdgeAreSmaller) {
    Image image = even(5, 5, 1);
    at(image, 4, 4) = 2;
    const Comparison result = compare_images(image, even(5, 5, 1), {.block_size = 4});
    EXPECT_EQ(result.blocks, 4u);
    EXPECT_EQ(result.worst_block, (PixelRect{4, 4, 5, 5}));
    EXPECT_DOUBLE_EQ(result.block_difference_max, 1);
}

TEST(CompareImages, HugeBlocksAreThePicture) {
    const Comparison result =
        compare_images(even(5, 3, 1), even(5, 3, 1), {.block_size = std::numeric_limits<int>::max()});
    EXPECT_EQ(result.blocks, 1u);
}

TEST(CompareImages, NonFinitePixelsAreCountedAndLeftOut) {
    Image image = even(4, 1, 1), reference = even(4, 1, 2);
    at(image, 0, 0) = not_a_number;
    at(image, 1, 0) = inf;
    at(reference, 1, 0) = not_a_number;
    at(reference, 2, 0) = -inf;
    const Comparison result = compare_images(image, reference, {.block_size = 1});
    EXPECT_EQ(result.non_finite_pixels, 3u);
    EXPECT_EQ(result.compared_pixels, 1u);
    EXPECT_FALSE(result.all_finite());
    EXPECT_DOUBLE_EQ(result.relative_l1, 0.5);
    EXPECT_EQ(result.blocks, 1u);
    EXPECT_EQ(result.worst_block, (PixelRect{3, 0, 4, 1}));
}

TEST(CompareImages, NothingFiniteIsReportedAndNotDivided) {
    const Comparison result = compare_images(even(2, 2, not_a_number), even(2, 2, 1));
    EXPECT_EQ(result.compared_pixels, 0u);
    EXPECT_EQ(result.blocks, 0u);
    EXPECT_EQ(result.rmse, 0);
}

TEST(CompareImages, SizesThatDifferAreNamed) {
    try {
        (void)compare_images(even(4, 3, 1), even(4, 2, 1));
        FAIL();
    } catch (const ImageError& error) {
        EXPECT_STREQ(error.what(), "image: expected 4 x 2 pixels like the reference, found 4 x 3 pixels");
    }
}

TEST(CompareImages, ImagesWithoutAPictureAndBadOptionsAreRefused) {
    Image albedo = even(1, 1, 1);
    albedo.layers[0].name = "albedo";
    EXPECT_THROW((void)compare_images(albedo, even(1, 1, 1)), ImageError);
    EXPECT_THROW((void)compare_images(even(1, 1, 1), albedo), ImageError);
    EXPECT_THROW((void)compare_images(even(1, 1, 1), even(1, 1, 1), {.block_size = 0}), SettingsError);
    EXPECT_THROW((void)compare_images(even(1, 1, 1), even(1, 1, 1), {.block_tolerance = std::nan("")}),
                 SettingsError);
}

// block means

TEST(CompareBlocks, MeansOfBlocksAgree) {
    const Image image = grey(4, 2, {1, 3, 5, 5, 2, 2, 7, 7}), reference = grey(2, 1, {2, 6});
    const BlockComparison result = compare_blocks(image, reference, {.sigmas = 0, .relative = 0});
    EXPECT_EQ(result.block_size, 2);
    EXPECT_EQ(result.columns, 2);
    EXPECT_EQ(result.rows, 1);
    EXPECT_EQ(result.included, 2u);
    EXPECT_EQ(result.failing, 0u);
    EXPECT_EQ(result.mean_ratio, 1);
    EXPECT_TRUE(result.passes());
}

TEST(CompareBlocks, StandardErrorsOfBothSidesCombine) {
    // SE of the image's mean: √(4 × 0.36) / 4 = 0.3; of the reference: 0.4; combined 0.5
    const Image image = even(2, 2, 12), reference = even(1, 1, 10), error = even(1, 1, 0.4f),
                variance = even(2, 2, 0.36f);
    const BlockComparison result =
        compare_blocks(image, reference, {.sigmas = 3, .relative = 0.05}, &error, &variance);
    EXPECT_NEAR(result.worst_sigmas, 2 / 0.5, 1e-6);
    EXPECT_NEAR(result.worst_of_allowed, 2 / (3 * 0.5 + 0.05 * 10), 1e-6);
    EXPECT_NEAR(result.mean_relative_difference, 0.2, 1e-12);
    EXPECT_NEAR(result.mean_ratio, 1.2, 1e-12);
    EXPECT_EQ(compare_blocks(image, reference, {.sigmas = 3.1, .relative = 0.05}, &error, &variance).failing,
              0u);
    EXPECT_EQ(compare_blocks(image, reference, {.sigmas = 2.9, .relative = 0.05}, &error, &variance).failing,
              1u);
    EXPECT_EQ(compare_blocks(image, reference, {.sigmas = 100, .relative = 0.05}).worst_sigmas, inf);
}

TEST(CompareBlocks, TheWorstBlockIsFound) {
    Image reference = colours(2, 2, std::vector<float>(12, 1));
    Image image = colours(2, 2, std::vector<float>(12, 1));
    image.layers[0].pixels[3 * 2 + 1] = 1.5f;  // block (0, 1), green
    image.layers[0].pixels[3 * 1 + 2] = 0.9f;
    const BlockComparison result = compare_blocks(image, reference, {.relative = 0.2});
    EXPECT_EQ(result.failing, 1u);
    EXPECT_EQ(result.worst_column, 0);
    EXPECT_EQ(result.worst_row, 1);
    EXPECT_EQ(result.worst_channel, 1);
    EXPECT_NEAR(result.worst_of_allowed, 2.5, 1e-6);
    EXPECT_NEAR(result.of_allowed[1], 0.5, 1e-6);
    EXPECT_NEAR(result.of_allowed[2], 2.5, 1e-6);
    EXPECT_NEAR(result.max_relative_difference, 0.5 / 3, 1e-6);
}

TEST(CompareBlocks, LightSourcesAndTheirNeighboursAreLeftOut) {
    Image reference = even(5, 5, 1), image = even(10, 10, 1);
    at(reference, 1, 1) = 20;
    at(image, 5, 5) = 9;  // block (2, 2): a neighbour over the corner
    const BlockComparison all = compare_blocks(image, reference);
    EXPECT_EQ(all.failing, 2u);
    const BlockComparison some = compare_blocks(image, reference, {.exclude_above = 10});
    EXPECT_EQ(some.excluded, 9u);
    EXPECT_EQ(some.included, 16u);
    EXPECT_EQ(some.failing, 0u);
    EXPECT_EQ(some.of_allowed[0], -1);
    EXPECT_EQ(some.of_allowed[3], 0);
    EXPECT_FALSE(compare_blocks(image, reference, {.exclude_above = 0.5}).passes()) << "nothing was compared";
}

TEST(CompareBlocks, NonFinitePixelsFailTheirBlock) {
    Image image = even(4, 4, 1);
    at(image, 3, 3) = not_a_number;
    const BlockComparison result = compare_blocks(image, even(2, 2, 1));
    EXPECT_EQ(result.non_finite_pixels, 1u);
    EXPECT_EQ(result.failing, 1u);
    EXPECT_EQ(result.of_allowed[3], inf);
    EXPECT_EQ(result.mean_ratio, 1);
    Image variance = even(4, 4, 0);
    at(variance, 0, 0) = -1;
    EXPECT_EQ(compare_blocks(even(4, 4, 1), even(2, 2, 1), {}, nullptr, &variance).failing, 1u);
}

TEST(CompareBlocks, ReferencesThatAreNotFiniteAreLeftOut) {
    Image reference = even(2, 2, 1), error = even(2, 2, 0.1f);
    at(reference, 0, 0) = not_a_number;
    at(error, 1, 1) = inf;
    const BlockComparison result = compare_blocks(even(4, 4, 1), reference, {}, &error);
    EXPECT_EQ(result.excluded, 2u);
    EXPECT_EQ(result.included, 2u);
    EXPECT_EQ(result.failing, 0u);
}

TEST(CompareBlocks, SizesThatDoNotFitAreNamed) {
    const Image reference = even(2, 2, 1);
    for (const auto& [width, height] : {std::pair{5, 4}, {4, 6}, {1, 1}, {6, 4}})
        EXPECT_THROW((void)compare_blocks(even(width, height, 1), reference), ImageError);
    EXPECT_THROW((void)compare_blocks(even(4, 4, 1), reference, {.sigmas = -1}), SettingsError);
    EXPECT_THROW((void)compare_blocks(even(4, 4, 1), reference, {.relative = std::nan("")}), SettingsError);
    const Image wrong = even(3, 3, 1);
    EXPECT_THROW((void)compare_blocks(even(4, 4, 1), reference, {}, &wrong), ImageError);
    EXPECT_THROW((void)compare_blocks(even(4, 4, 1), reference, {}, nullptr, &wrong), ImageError);
}

// signed difference

TEST(SignedDifference, RedIsBrighterBlueIsDarkerWhiteIsEqual) {
    const Image picture = signed_difference(grey(3, 1, {2, 0, 1}), even(3, 1, 1), 1);
    const std::array<float, 3> brighter = picture.rgb(0, 0), darker = picture.rgb(1, 0),
                               equal = picture.rgb(2, 0);
    EXPECT_GT(brighter[0], 4 * brighter[2]);
    EXPECT_GT(darker[2], 4 * darker[0]);
    for (const float channel : equal) EXPECT_NEAR(channel, 1, 1e-3);
    EXPECT_EQ(picture.metadata.at("difference_scale"), "1");
}

TEST(SignedDifference, BothSignsFallInBrightnessAlike) {
    float last = 2;
    for (int step = 1; step <= 10; ++step) {
        const float d = 0.1f * static_cast<float>(step);
        const Image picture = signed_difference(grey(2, 1, {1 + d, 1 - d}), even(2, 1, 1), 1);
        const auto luminance = [&](int x) {
            const std::array<float, 3> c = picture.rgb(x, 0);
            return 0.2126f * c[0] + 0.7152f * c[1] + 0.0722f * c[2];
        };
        EXPECT_NEAR(std::cbrt(luminance(0)), std::cbrt(luminance(1)), 0.08) << step;
        EXPECT_LT(luminance(0), last);
        last = luminance(0);
    }
}

TEST(SignedDifference, AutomaticScaleIsThe99thPercentile) {
    std::vector<float> values;
    for (int i = 0; i <= 100; ++i) values.push_back(static_cast<float>(i));
    values[100] = 1e6f;  // a firefly does not bleach the picture
    const Image picture = signed_difference(grey(101, 1, values), even(101, 1, 0));
    EXPECT_NEAR(std::stod(picture.metadata.at("difference_scale")), 99, 1e-3);
    EXPECT_EQ(picture.rgb(100, 0), picture.rgb(99, 0));
    EXPECT_EQ(signed_difference(even(2, 2, 1), even(2, 2, 1)).metadata.at("difference_scale"), "1");
}

TEST(SignedDifference, NonFinitePixelsAreGreen) {
    const Image picture = signed_difference(grey(2, 1, {not_a_number, inf}), even(2, 1, 1));
    EXPECT_EQ(picture.rgb(0, 0), (std::array<float, 3>{0, 1, 0}));
    EXPECT_EQ(picture.rgb(1, 0), (std::array<float, 3>{0, 1, 0}));
}

TEST(SignedDifference, SizesAndScalesAreChecked) {
    EXPECT_THROW((void)signed_difference(even(2, 2, 1), even(3, 2, 1)), ImageError);
    EXPECT_THROW((void)signed_difference(even(2, 2, 1), even(2, 2, 1), std::nan("")), SettingsError);
}

}  // namespace
}  // namespace relumine
