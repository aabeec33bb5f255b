// SPDX-License-Identifier: Apache-2.0
// The noise that pixels are believed to have, and what the filter makes of it.
#include "integrators/error_prediction.hpp"

#include <gtest/gtest.h>

#include "base/hash.hpp"

namespace relumine {
namespace {

constexpr int side = 96, levels = 3;
constexpr std::uint64_t rays = 64;

/// An open floor, a pixel covers a centimetre.
FilterImage open_floor() {
    FilterImage image{side, side, {}, {}, {}};
    for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x)
            image.guides.push_back(
                {{0.01f * static_cast<float>(x), 0.01f * static_cast<float>(y), 0}, {0, 0, 1}, 0.01f, 0});
    return image;
}

/// Rays that find 1 once in `rarity`, and little otherwise.
RayNoise rare_finds(std::uint64_t pixel, std::uint64_t rarity) {
    RayNoise noise;
    noise.rays = rays;
    for (std::uint64_t ray = 0; ray < rays; ++ray) {
        const std::uint64_t drawn = hash(pixel, ray);
        noise.count(2 * ray >= rays,
                    drawn % rarity == 0 ? 1 : 1e-3f * unit_float(static_cast<std::uint32_t>(drawn >> 32)));
    }
    return noise;
}

struct Picture {
    std::vector<PixelDoubt> doubts;
    FilterParts parts{1};

    void add(const RayNoise& noise) {
        PixelDoubt doubt;
        doubt.residual = noise_of(noise);
        doubt.albedo = 1;
        doubts.push_back(doubt);
        parts[0].emplace_back(noise.halves[0] + noise.halves[1]);
    }
    void smooth() {
        const FilterImage floor = open_floor();
        const auto variances = noise_variances(floor, doubts, &PixelDoubt::residual, 1);
        static_cast<void>(smooth_noise(floor, parts, variances, levels, 1));
    }
    [[nodiscard]] double brightest() const {
        double found = 0;
        for (const Spectrum& v : parts[0]) found = std::max(found, double{v.r});
        return found;
    }
};

/// About 15 and 150 finds on the floor. Of the latter .8 stay where halves that happen to agree are believed.
TEST(NoiseVariances, LeaveNoDotsOfRareFinds) {
    for (const std::uint64_t rarity : {40'000u, 4'000u}) {
        Picture picture;
        for (std::uint64_t pixel = 0; pixel < side * side; ++pixel) picture.add(rare_finds(pixel, rarity));
        ASSERT_GT(picture.brightest(), 0.99);
        picture.smooth();
        EXPECT_LT(picture.brightest(), 0.3) << rarity;
    }
}

/// A shadow's edge, found alike by all rays.
TEST(NoiseVariances, KeepAnEdgeThatAllRaysSee) {
    Picture picture;
    for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x) {
            RayNoise noise;
            noise.rays = rays;
            for (std::uint64_t ray = 0; ray < rays; ++ray)
                noise.count(2 * ray >= rays, x < side / 2 ? 0 : 1.0f / rays);
            picture.add(noise);
        }
    picture.smooth();
    for (int x = 0; x < side; ++x) {
        const float v = picture.parts[0][static_cast<std::size_t>(side / 2 * side + x)].r;
        EXPECT_NEAR(v, x < side / 2 ? 0 : 1, 0.01) << x;
    }
}

}  // namespace
}  // namespace relumine
