// SPDX-License-Identifier: Apache-2.0
// The filter over residuals: along surfaces, not across their edges, as far as it says.
#include "integrators/residual_filter.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <utility>

#include "base/hash.hpp"

namespace relumine {
namespace {

constexpr int width = 48, height = 40, levels = 3;

std::size_t at(int x, int y) { return static_cast<std::size_t>(y * width + x); }

/// A floor seen from above, a pixel covers a centimetre; values by pixel.
template <typename Value>
FilterImage floor_with(const Value& value) {
    FilterImage image{width, height, {}, {}, {}};
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            image.guides.push_back(
                {{0.01f * static_cast<float>(x), 0.01f * static_cast<float>(y), 0}, {0, 0, 1}, 0.01f, 0});
            image.values.push_back(value(x, y));
        }
    return image;
}

NoiseVariances known(const std::vector<float>& variances) { return {variances, variances}; }

Spectrum noise(int x, int y) { return Spectrum{unit_float(static_cast<std::uint32_t>(hash(at(x, y), 1)))}; }

TEST(ResidualFilter, KeepsAConstant) {
    FilterImage image = floor_with([](int, int) { return Spectrum{0.3f, -2, 5}; });
    for (int x = 0; x < width; x += 7) image.guides[at(x, 9)].normal = normalize({1, 0.3f, 1});
    filter_along_surfaces(image, levels, 2);
    for (const Spectrum& v : image.values) {
        ASSERT_NEAR(v.r, 0.3f, 1e-6f);
        ASSERT_NEAR(v.g, -2, 1e-5f);
        ASSERT_NEAR(v.b, 5, 2e-5f);
    }
}

TEST(ResidualFilter, LowersNoise) {
    FilterImage image = floor_with(noise);
    const auto variance = [&] {
        double sum = 0, squares = 0;
        for (const Spectrum& v : image.values) sum += v.r, squares += double{v.r} * v.r;
        const auto n = static_cast<double>(image.values.size());
        return squares / n - sum / n * (sum / n);
    };
    const double before = variance();
    filter_along_surfaces(image, levels, 1);
    EXPECT_LT(variance(), before / 30);
}

/// Where a single lit pixel is spread to.
FilterImage spread(int filter_levels) {
    FilterImage image = floor_with([](int x, int y) { return Spectrum{x == 20 && y == 18 ? 1.0f : 0.0f}; });
    filter_along_surfaces(image, filter_levels, 1);
    return image;
}

TEST(ResidualFilter, ReachesAsFarAsItSays) {
    for (const int n : {1, 2, 3}) {
        const FilterImage image = spread(n);
        int farthest = 0;
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x)
                if (image.values[at(x, y)].r > 0)
                    farthest = std::max({farthest, std::abs(x - 20), std::abs(y - 18)});
        EXPECT_EQ(farthest, filter_reach(n)) << n;
    }
    EXPECT_EQ(filter_reach(0), 0);
    EXPECT_EQ(spread(0).values[at(20, 18)], Spectrum{1});
}

/// Left and right of x = 24 lie surfaces that `change` tells apart; how much of a step of 1 leaks over.
template <typename Change>
float leak(const Change& change) {
    FilterImage image = floor_with([](int x, int) { return Spectrum{x < 24 ? 1.0f : 0.0f}; });
    for (int y = 0; y < height; ++y)
        for (int x = 24; x < width; ++x) change(image.guides[at(x, y)]);
    filter_along_surfaces(image, levels, 1);
    float most = 0;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            most = std::max(most, std::abs(image.values[at(x, y)].r - (x < 24 ? 1.0f : 0.0f)));
    return most;
}

TEST(ResidualFilter, DoesNotMixSurfaces) {
    EXPECT_GT(leak([](FilterGuide&) {}), 0.3f);  // one surface
    EXPECT_LT(leak([](FilterGuide& g) { g.normal = {1, 0, 0}; }), 1e-6f);
    EXPECT_LT(leak([](FilterGuide& g) { g.normal = normalize({1, 0, 1}); }), 1e-4f);
    EXPECT_LT(leak([](FilterGuide& g) { g.position.z += 1; }), 1e-4f);
    EXPECT_EQ(leak([](FilterGuide& g) { g.material = 7; }), 0);  // a lamp on the ceiling, say
}

/// A floor, from x = 24 on a wall that rises from it (the picture shows both equally large).
FilterImage corner_with(const std::function<Spectrum(int, int)>& value) {
    FilterImage image = floor_with(value);
    for (int y = 0; y < height; ++y)
        for (int x = 24; x < width; ++x) {
            FilterGuide& g = image.guides[at(x, y)];
            g.position = {0.24f, 0.01f * static_cast<float>(y), 0.01f * static_cast<float>(x - 23)};
            g.normal = {-1, 0, 0};
        }
    return image;
}

TEST(ResidualFilter, FindsContacts) {
    FilterImage image = corner_with([](int, int) { return Spectrum{}; });
    find_contacts(image, 2);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const int pixels = x < 24 ? 24 - x : x - 23;
            ASSERT_EQ(image.guides[at(x, y)].contact, std::min(pixels, contact_reach + 1)) << x;
        }
    // Neither an edge that falls away nor something far in front is one.
    for (const bool far : {false, true}) {
        image = corner_with([](int, int) { return Spectrum{}; });
        for (int y = 0; y < height; ++y)
            for (int x = 24; x < width; ++x) {
                FilterGuide& g = image.guides[at(x, y)];
                g.position.z = far ? g.position.z + 1 : -g.position.z;
            }
        find_contacts(image, 1);
        for (int x = 0; x < 24; ++x)
            ASSERT_EQ(image.guides[at(x, 20)].contact, contact_reach + 1) << far << x;
    }
}

/// What maps get wrong in the last row of a floor before a wall is brought back from there, not spread:
/// without contacts only half of it comes back (numbers are fixed, so nothing here is left to chance).
TEST(ResidualFilter, KeepsWhatIsWrongAlongAContact) {
    const auto value = [](int x, int y) {
        return noise(x, y) * 0.5f - Spectrum{0.25f} + Spectrum{x == 23 ? 0.3f : 0.0f};
    };
    const auto along = [&](bool contacts) {
        FilterImage image = corner_with(value);
        if (contacts) find_contacts(image, 1);
        FilterParts parts{std::exchange(image.values, {})};
        (void)smooth_noise(std::move(image), parts, known(std::vector<float>(width * height, 0.25f / 12)),
                           levels, 1);
        float sum = 0;
        for (int y = 0; y < height; ++y) sum += parts[0][at(23, y)].r / (0.3f * height);
        return sum;
    };
    EXPECT_NEAR(along(true), 1, 0.1);
    EXPECT_LT(along(false), 0.7);
}

TEST(ResidualFilter, SkipsPixelsWithoutASurface) {
    FilterImage image = floor_with([](int x, int y) { return Spectrum{x == 5 && y == 5 ? 1000.0f : 1.0f}; });
    image.guides[at(5, 5)].footprint = 0;
    filter_along_surfaces(image, levels, 1);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            if (x != 5 || y != 5) {
                ASSERT_NEAR(image.values[at(x, y)].r, 1, 1e-5f);
            }
        }
    EXPECT_TRUE(is_black(image.values[at(5, 5)]));
}

TEST(ResidualFilter, IsTheSameForAnyNumberOfThreads) {
    FilterImage one = floor_with(noise), seven = one;
    filter_along_surfaces(one, levels, 1);
    filter_along_surfaces(seven, levels, 7);
    EXPECT_EQ(one.values, seven.values);
}

/// Over pictures of white noise, pixel by pixel, with a step down the middle. The variance of 400 values has
/// a standard error of 7 %, the mean over many pixels one of 1 %.
TEST(ResidualFilter, PredictsTheVarianceThatItLeaves) {
    constexpr int pictures = 100;
    const auto with_step = [](const auto& value) {
        FilterImage image = floor_with(value);
        for (std::size_t i = 0; i < image.guides.size(); ++i)
            if (i % width > width / 2) image.guides[i].position.z = 1;
        return image;
    };
    for (int filter_levels = 1; filter_levels <= 3; ++filter_levels) {
        FilterImage predicted = with_step([](int, int) { return Spectrum{1.0f / 12}; });
        filter_variances(predicted, filter_levels, 1);
        std::vector<double> sums(predicted.values.size()), squares(predicted.values.size());
        for (std::uint64_t seed = 0; seed < pictures; ++seed) {
            FilterImage image = with_step([&](int x, int y) {
                return Spectrum{unit_float(static_cast<std::uint32_t>(hash(at(x, y), seed)))};
            });
            filter_along_surfaces(image, filter_levels, 1);
            for (std::size_t i = 0; i < sums.size(); ++i) {
                sums[i] += image.values[i].r;
                squares[i] += double{image.values[i].r} * image.values[i].r;
            }
        }
        const auto ratio = [&](int x0, int x1) {  // predicted over true
            double expected = 0, seen = 0;
            for (int y = 14; y < height - 14; ++y)
                for (int x = x0; x < x1; ++x) {
                    expected += predicted.values[at(x, y)].r;
                    seen += (squares[at(x, y)] - sums[at(x, y)] * sums[at(x, y)] / pictures) / (pictures - 1);
                }
            return expected / seen;
        };
        EXPECT_NEAR(ratio(14, width / 2 - 12 + 4), 1, filter_levels == 1 ? 0.05 : 0.25) << filter_levels;
        const double at_step = ratio(width / 2 - 1, width / 2 + 1);
        EXPECT_GT(at_step, 0.5) << filter_levels;
        EXPECT_LT(at_step, 2) << filter_levels;
    }
}

/// A stripe of one pixel of height `stripe`, and white noise of variance 1/12 in two parts of opposite sign.
struct Smoothed {
    double off = 0, predicted = 0;  // rms errors away from borders
    float on_stripe = 0;            // mean there
};
Smoothed smoothed(float stripe, bool says_noise) {
    const auto truth = [&](std::size_t i) { return i % width == 24 ? stripe : 0; };
    const FilterImage guides = floor_with([](int, int) { return Spectrum{}; });
    FilterParts parts(2, std::vector<Spectrum>(guides.values.size()));
    for (std::size_t i = 0; i < guides.values.size(); ++i) {
        const float part = unit_float(static_cast<std::uint32_t>(hash(i, 5)));
        parts[0][i] = Spectrum{truth(i) + unit_float(static_cast<std::uint32_t>(hash(i, 9))) - 0.5f + part};
        parts[1][i] = Spectrum{-part};
    }
    const std::vector<float> variances(guides.values.size(), says_noise ? 1.0f / 12 : 0);
    const std::vector<float> error = smooth_noise(guides, parts, known(variances), levels, 2);
    Smoothed result;
    double pixels = 0;
    for (int y = 8; y < height - 8; ++y) {
        result.on_stripe += (parts[0][at(24, y)].r + parts[1][at(24, y)].r) / (height - 16);
        for (int x = 8; x < width - 8; ++x) {
            const double off = parts[0][at(x, y)].r + parts[1][at(x, y)].r - truth(at(x, y));
            result.off += off * off;
            result.predicted += error[at(x, y)];
            ++pixels;
        }
    }
    result.off = std::sqrt(result.off / pixels);
    result.predicted = std::sqrt(result.predicted / pixels);
    return result;
}

TEST(ResidualFilter, RemovesWhatIsSaidToBeNoise) {
    const Smoothed flat = smoothed(0, true);
    EXPECT_LT(flat.off, 0.4 * std::sqrt(1.0 / 12));
    EXPECT_GT(flat.predicted, 0.8 * flat.off);
    EXPECT_LT(flat.predicted, 2 * flat.off);  // what stays by chance might have been more than noise
}

/// A pixel in forty has found what forty shine, and knows it, as pixels do: by its squares, averaged over its
/// surroundings. What is dark around it must not stay dark on account of it.
TEST(ResidualFilter, RareFindsKeepTheirEnergy) {
    const auto found = [](int x, int y) { return hash(at(x, y), 3) % 40 == 0 ? Spectrum{40} : Spectrum{}; };
    const FilterImage guides = floor_with(found);
    FilterImage squares = floor_with([&](int x, int y) { return found(x, y) * found(x, y); });
    filter_along_surfaces(squares, noise_levels, 1);
    std::vector<float> variances;
    for (const Spectrum& v : squares.values) variances.push_back(v.r);
    const auto mean = [](const std::vector<Spectrum>& values) {
        double sum = 0;
        for (const Spectrum& v : values) sum += v.r;
        return sum / static_cast<double>(values.size());
    };
    FilterImage plain = guides;
    filter_along_surfaces(plain, levels, 1);  // keeps it all, but at the picture's border
    FilterParts parts{guides.values};
    static_cast<void>(smooth_noise(guides, parts, known(variances), levels, 1));
    EXPECT_NEAR(mean(parts[0]) / mean(plain.values), 1, 0.015);  // .890 where v − v′ is what noise explains
}

/// Tiles of two albedos have found light that is no multiple of what they reflect, as glossy ones do.
TEST(ResidualFilter, TilesOfDifferentAlbedoKeepTheirEnergy) {
    const auto is_dark = [](int x, int y) { return (x / 3 + y / 3) % 2 == 0; };
    const auto albedo = [&](int x, int y) { return Spectrum{is_dark(x, y) ? 0.04f : 0.8f}; };
    const auto found = [&](int x, int y) { return is_dark(x, y) ? -0.02f : -0.1f; };
    FilterImage guides = floor_with(albedo);
    guides.weights = guides.values;
    FilterParts parts{
        floor_with([&](int x, int y) { return Spectrum{found(x, y) / albedo(x, y).r}; }).values};
    static_cast<void>(
        smooth_noise(guides, parts, known(std::vector<float>(guides.values.size(), 1e6f)), levels, 1));
    double before = 0, after = 0;
    for (int y = 8; y < height - 8; ++y)
        for (int x = 12; x < width - 12; ++x) {
            before += double{found(x, y)};
            after += double{parts[0][at(x, y)].r * albedo(x, y).r};
        }
    EXPECT_NEAR(after / before, 1, 0.01);  // 2.2 where all quotients count alike
}

TEST(ResidualFilter, KeepsWhatNoiseDoesNotExplain) {
    const Smoothed fine = smoothed(4, true);
    EXPECT_GT(fine.on_stripe, 3);  // the plain filter leaves a fifth of it
    EXPECT_LT(fine.on_stripe, 4.2f);
    EXPECT_NEAR(smoothed(1, false).off, std::sqrt(1.0 / 12), 0.02);  // nothing is noise: all stays
    EXPECT_EQ(smoothed(1, false).predicted, 0);
}

}  // namespace
}  // namespace relumine
