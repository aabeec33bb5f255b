// SPDX-License-Identifier: Apache-2.0
// What a pass of `cache` found, filtered strip by strip: the same bits as all at once, in less memory.
#include "integrators/residual_film.hpp"

#include <gtest/gtest.h>

#include "base/hash.hpp"

namespace relumine {
namespace {

constexpr int width = 10, height = 3 * ResidualFilm::least_strip_rows + 5, row_step = 16;

float random(int x, int y, std::uint64_t what) {
    return unit_float(static_cast<std::uint32_t>(hash(static_cast<std::uint64_t>(y * width + x), what)));
}

/// Two surfaces that meet along a slanted line, under noise that every pixel knows of.
void put_row(ResidualFilm& film, int y) {
    for (int x = 0; x < width; ++x) {
        const Spectrum found{random(x, y, 1)}, albedo{0.2f + 0.5f * random(x, y, 2)};
        PixelDoubt doubt{{0.1f, 0.1f, 4}, {0.05f, 0.02f, 4}, luminance(albedo), 0.1f, 0.01f};
        const std::uint32_t surface = 40 * x > y ? 1 : 0;
        film.put(
            x, y, {found, found * 0.5f, found * 2, albedo}, doubt,
            {{0.01f * static_cast<float>(x), 0.01f * static_cast<float>(y), 0}, {0, 0, 1}, 0.01f, surface});
    }
}

/// The rows [0, `end`) of a pass, taken in a few at a time.
std::vector<PixelSums> filtered_rows(ResidualFilm film, int end, int step) {
    const ResidualFilm::Adding how{false, true, 1};
    std::vector<PixelSums> pixels(std::size_t{width} * height);
    film.begin(width);
    for (int y = 0; y < end; y += step) {
        const int stop = std::min(y + step, end);
        film.take_in(stop);
        for (int row = y; row < stop; ++row) put_row(film, row);
        film.add_to(pixels, how);
    }
    film.finish(pixels, how);
    return pixels;
}

void expect_same(const std::vector<PixelSums>& a, const std::vector<PixelSums>& b, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
        ASSERT_EQ(a[i].radiance, b[i].radiance) << i / width;
        ASSERT_EQ(a[i].split.indirect, b[i].split.indirect) << i / width;
        ASSERT_EQ(a[i].error.variance, b[i].error.variance) << i / width;
        ASSERT_EQ(a[i].error.deviation, b[i].error.deviation) << i / width;
    }
}

TEST(ResidualFilm, StripsChangeNoBit) {
    const std::vector<PixelSums> whole = filtered_rows({true, true}, height, height);
    expect_same(whole, filtered_rows({true, true, 1}, height, row_step), whole.size());
    expect_same(whole, filtered_rows({true, true, 1}, height, height), whole.size());
    EXPECT_GT(whole[0].radiance.r, 0);
    EXPECT_GT(whole.back().radiance.r, 0);
}

TEST(ResidualFilm, StripsChangeNoBitWithoutTheFilter) {
    const std::vector<PixelSums> whole = filtered_rows({false, true}, height, height);
    expect_same(whole, filtered_rows({false, true, 1}, height, row_step), whole.size());
    EXPECT_EQ(whole[0].radiance.r, 0);
    EXPECT_GT(whole[0].error.variance, 0);
}

TEST(ResidualFilm, AStopLeavesWhatWasTakenIn) {
    const int end = ResidualFilm::least_strip_rows + 70;  // within the second strip
    const std::vector<PixelSums> some = filtered_rows({true, true, 1}, end, row_step);
    EXPECT_GT(some[std::size_t{width} * end - 1].radiance.r, 0);
    EXPECT_EQ(some[std::size_t{width} * end].radiance.r, 0);
}

TEST(ResidualFilm, HoldsNoMoreThanAStripAndItsSurroundings) {
    const ResidualFilm film(true, true, 1);
    const std::size_t row = film.bytes(width, 1);
    EXPECT_EQ(film.bytes(width, 10'000),
              row * static_cast<std::size_t>(ResidualFilm::least_strip_rows + 2 * film.reach() + 16));
}

}  // namespace
}  // namespace relumine
