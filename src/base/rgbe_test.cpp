// SPDX-License-Identifier: Apache-2.0
// RGBE: how far it rounds, what it keeps exactly, where it ends.
#include "base/rgbe.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "base/hash.hpp"

namespace relumine {
namespace {

/// Half a unit of the mantissa against the least largest channel that is stored with that unit.
constexpr float half_unit = 1 / 255.5f;

/// Channels spread evenly over 20 stops below a largest one of 2^stop.
Spectrum random_spectrum(std::uint64_t i, float stop) {
    const auto channel = [&](std::uint64_t c) {
        const float u = unit_float(static_cast<std::uint32_t>(hash(i, c)));
        return std::exp2(stop - (c == i % 3 ? u : 20 * u));
    };
    return {channel(0), channel(1), channel(2)};
}

float largest_error(Spectrum s) {
    const Spectrum back = unpack_rgbe(pack_rgbe(s));
    return std::max({std::abs(back.r - s.r), std::abs(back.g - s.g), std::abs(back.b - s.b)});
}

TEST(Rgbe, ErrorIsHalfAUnitOfTheLargestChannel) {
    float worst = 0;
    for (std::uint64_t i = 0; i < 300'000; ++i) {
        const Spectrum s = random_spectrum(i, static_cast<float>(i % 240) - 116);
        worst = std::max(worst, largest_error(s) / max_component(s));
        ASSERT_LE(worst, half_unit * 1.0001f) << s.r << " " << s.g << " " << s.b;
    }
    EXPECT_GT(worst, 0.99f * half_unit);  // the bound is tight
}

TEST(Rgbe, RoundsToNearestSoThatMeansStay) {
    constexpr std::uint64_t count = 300'000;
    double error = 0;
    for (std::uint64_t i = 0; i < count; ++i) {
        const float dim = unit_float(static_cast<std::uint32_t>(hash(i, 3)));
        error += unpack_rgbe(pack_rgbe({dim, 0.9f, 0})).r - dim;
    }
    EXPECT_NEAR(error / count, 0,
                1.2e-5);  // 6 sigma of roundings by up to ±1/512; truncation would give −2e-3
}

TEST(Rgbe, PowersOfTwoAreExact) {
    for (int stop = -119; stop <= 126; ++stop) {
        const float power = std::ldexp(1.0f, stop);
        EXPECT_EQ(unpack_rgbe(pack_rgbe(Spectrum{power})), Spectrum{power}) << stop;
        const Spectrum colour{power, power / 4, power / 128};
        if (stop >= -112) {
            EXPECT_EQ(unpack_rgbe(pack_rgbe(colour)), colour) << stop;
        }
    }
}

TEST(Rgbe, WholeMantissasAreExact) {
    for (int m = 128; m < 256; ++m) {
        const Spectrum s{static_cast<float>(m), static_cast<float>(m - 128), 1};
        EXPECT_EQ(unpack_rgbe(pack_rgbe(s)), s) << m;
    }
}

TEST(Rgbe, PackingTwiceChangesNothing) {
    for (std::uint64_t i = 0; i < 100'000; ++i) {
        const std::uint32_t packed = pack_rgbe(random_spectrum(i, static_cast<float>(i % 240) - 116));
        ASSERT_EQ(pack_rgbe(unpack_rgbe(packed)), packed);
    }
}

TEST(Rgbe, BlackIsZero) {
    EXPECT_EQ(pack_rgbe({}), 0u);
    EXPECT_EQ(unpack_rgbe(0), Spectrum{});
    EXPECT_EQ(pack_rgbe({-1, 0, -0.0f}), 0u);
}

TEST(Rgbe, NegativeChannelsAreBlack) {
    EXPECT_EQ(unpack_rgbe(pack_rgbe({1, -1, 0.5f})), (Spectrum{1, 0, 0.5f}));
}

TEST(Rgbe, TinyRadianceIsBlack) {
    EXPECT_EQ(pack_rgbe(Spectrum{std::numeric_limits<float>::denorm_min()}), 0u);
    EXPECT_EQ(pack_rgbe(Spectrum{std::numeric_limits<float>::min()}), 0u);
    EXPECT_EQ(pack_rgbe(Spectrum{std::ldexp(1.0f, -120)}), 0u);
    EXPECT_NE(pack_rgbe(Spectrum{std::ldexp(1.0f, -119)}), 0u);
}

TEST(Rgbe, HugeRadianceStaysFiniteAndDoesNotWrapAround) {
    constexpr float most = std::numeric_limits<float>::max();
    const float brightest = std::ldexp(255.0f, 119);
    EXPECT_EQ(unpack_rgbe(pack_rgbe(Spectrum{most})), Spectrum{brightest});
    EXPECT_EQ(unpack_rgbe(pack_rgbe({most, 0, most / 2})), (Spectrum{brightest, 0, brightest}));
    EXPECT_NEAR(unpack_rgbe(pack_rgbe(Spectrum{1e38f})).r / 1e38f, 1, half_unit);
}

TEST(Rgbe, TheNextPowerOfTwoIsReachedByRounding) {
    EXPECT_EQ(unpack_rgbe(pack_rgbe(Spectrum{255.6f})), Spectrum{256});
    EXPECT_EQ(unpack_rgbe(pack_rgbe(Spectrum{255.4f})), Spectrum{255});
}

}  // namespace
}  // namespace relumine
