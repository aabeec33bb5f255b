// SPDX-License-Identifier: Apache-2.0
// Making records: layers, merged surfels, bytes.
#include "cache/record.hpp"

#include <gtest/gtest.h>

#include "base/rgbe.hpp"
#include "cache/surfel_merge.hpp"
#include "cache/test_stage.hpp"

namespace relumine {
namespace {

using testing::Stage;

const Spectrum red{1, 0, 0}, green{0, 1, 0}, sky{0.25f, 0.25f, 0.5f};

/// A wall behind a bar, both in front of a floor point at the origin.
Stage bar_and_wall() {
    return Stage({{{-20, -1, -4}, {40, 0, 0}, {0, 20, 0}, green},
                  {{-0.4f, 0.3f, -1}, {0.8f, 0, 0}, {0, 0.3f, 0}, red}},
                 sky);
}

std::vector<TexelSample> random_texels(int side) {
    std::vector<TexelSample> texels(static_cast<std::size_t>(side * side));
    for (std::size_t i = 0; i < texels.size(); ++i) {
        const std::uint64_t bits = hash(i, 7);
        if (bits % 5 == 0) continue;  // a miss
        texels[i].distance = std::exp(4 * unit_float(static_cast<std::uint32_t>(bits >> 32)));
        texels[i].normal = {0, -1, 0};
        texels[i].offset = {0, texels[i].distance, 0};
    }
    return texels;
}

TEST(Layers, AreInOrderOfDistanceAndMissesAreLast) {
    const std::vector<TexelSample> texels = random_texels(16);
    const DepthLayers layers = sort_into_layers(texels, 16);
    for (std::size_t i = 0; i < texels.size(); ++i)
        for (std::size_t j = 0; j < texels.size(); ++j) {
            const bool nearer = texels[i].distance < texels[j].distance;
            EXPECT_TRUE(!nearer || layers.layer_of_texel[i] <= layers.layer_of_texel[j]);
            EXPECT_EQ(texels[i].distance == infinity, layers.layer_of_texel[i] == 16);
        }
}

TEST(Layers, OneDistanceIsOneLayer) {
    std::vector<TexelSample> texels(16);
    for (TexelSample& t : texels) t.distance = 2;
    for (const std::uint8_t layer : sort_into_layers(texels, 8).layer_of_texel) EXPECT_EQ(layer, 0);
}

/// Only surfels at infinity may carry texels of other layers.
TEST(SurfelMerge, CoversEveryTexelOnceInItsLayer) {
    const std::vector<TexelSample> texels = random_texels(32);
    const DepthLayers layers = sort_into_layers(texels, 8);
    const Surfels surfels =
        merge_surfels(texels, layers, {{}, frame_around({0, 1, 0})}, 32, {.reuse_distance = 0.1f});
    std::vector<int> covered(texels.size());
    for (std::size_t layer = 0; layer < surfels.layers(); ++layer)
        for (std::size_t i = surfels.layer_begin[layer]; i < surfels.layer_begin[layer + 1]; ++i) {
            const TexelRect& r = surfels.texels[i];
            EXPECT_LE(std::max(r.width, r.height), max_surfel_side);
            for (int v = r.v; v < r.v + r.height; ++v)
                for (int u = r.u; u < r.u + r.width; ++u) {
                    const auto texel = static_cast<std::size_t>(v * 32 + u);
                    const bool own = layers.layer_of_texel[texel] == layer;
                    EXPECT_TRUE(own || layer + 1 == surfels.layers());
                    covered[texel] += own ? 1 : 0;
                }
        }
    for (const int count : covered) EXPECT_EQ(count, 1);
}

TEST(SurfelMerge, BlackSurfelsAreTheLastOfTheirLayer) {
    std::vector<TexelSample> texels = random_texels(32);
    for (std::size_t i = 0; i < texels.size(); i += 3) texels[i].radiance = red;
    const Surfels surfels = merge_surfels(texels, sort_into_layers(texels, 8), {{}, frame_around({0, 1, 0})},
                                          32, {.reuse_distance = 0.1f});
    ASSERT_EQ(surfels.black_begin.size(), surfels.layers());
    for (std::size_t layer = 0; layer < surfels.layers(); ++layer)
        for (std::size_t i = surfels.layer_begin[layer]; i < surfels.layer_begin[layer + 1]; ++i) {
            const TexelRect& r = surfels.texels[i];
            bool black = true;
            for (int v = r.v; v < r.v + r.height; ++v)
                for (int u = r.u; u < r.u + r.width; ++u)
                    black = black && is_black(texels[static_cast<std::size_t>(v * 32 + u)].radiance);
            EXPECT_EQ(black, i >= surfels.black_begin[layer]);
        }
}

TEST(SurfelMerge, OnlyWhatIsHitIsBlackUnderASky) {
    const Record record = Stage({{{-50, 3, -50}, {50, 0, 0}, {0, 0, 100}, {}}}, sky).record({}, {0, 1, 0});
    const Surfels& s = record.surfels;
    ASSERT_GT(s.infinity_begin(), 50u);
    for (std::size_t layer = 0; layer + 1 < s.layers(); ++layer)
        EXPECT_EQ(s.black_begin[layer], s.layer_begin[layer]);
    EXPECT_EQ(s.black_begin.back(), s.count);
}

TEST(SurfelMerge, MergesPlanesAndNotSteps) {
    const Record plane = Stage({{{-50, 3, -50}, {100, 0, 0}, {0, 0, 100}, red}}, sky).record({}, {0, 1, 0});
    EXPECT_LT(plane.surfels.count, 4096u / 3);  // layers cut the plane into rings
    const Record empty = Stage({}, sky).record({}, {0, 1, 0});
    EXPECT_EQ(empty.surfels.count, 64u);  // 8 × 8 surfels of 8 × 8 texels
    EXPECT_EQ(empty.surfels.infinity_begin(), 0u);
}

TEST(Record, TextureIsWhatRaysBringBack) {
    const Record record = bar_and_wall().record({}, {0, 1, 0});
    std::size_t reds = 0, greens = 0, skies = 0;
    for (std::size_t i = 0; i < 4096; ++i) {
        const Spectrum s = unpack_rgbe(record.radiance[i]);
        reds += s == red;
        greens += s == green;
        skies += s == sky;
    }
    EXPECT_EQ(reds + greens + skies, 4096u);
    EXPECT_GT(std::min({reds, greens, skies}), 50u);
    EXPECT_TRUE(record.direct.empty());
    EXPECT_GT(record.bytes(), 16384u);
}

TEST(Record, HarmonicDistanceOfAPlaneOverhead) {
    // 1/t = cos θ / h on an infinite plane at height h, whose mean over the hemisphere is 1/(2h).
    const Record record =
        Stage({{{-5e4f, 3, -5e4f}, {1e5f, 0, 0}, {0, 0, 1e5f}, red}}, {}).record({}, {0, 1, 0});
    EXPECT_NEAR(record.harmonic_distance, 6, 0.03);
    EXPECT_NEAR(record.nearest, 3, 0.03);
}

TEST(Record, CountsRadianceThatIsNotFinite) {
    const Stage stage({{{-50, 3, -50}, {100, 0, 0}, {0, 0, 100}, Spectrum{infinity}}}, sky);
    RayCounts rays;
    const FlushDenormals flush;
    const Record record = make_record(stage.source(), {{}, frame_around({0, 1, 0}), 1e-5f, 0}, {16, 16},
                                      {0, 0.1f, 0.1f}, 1, rays);
    EXPECT_GT(rays.non_finite, 200u);
    EXPECT_EQ(std::ranges::count(std::span(record.radiance).first(256), 0u),
              static_cast<std::ptrdiff_t>(rays.non_finite));
}

TEST(Record, IsAFunctionOfItsKey) {
    const Stage stage = bar_and_wall();
    const Record a = stage.record({}, {0, 1, 0}, 64, 0.1f, 1), b = stage.record({}, {0, 1, 0}, 64, 0.1f, 1),
                 c = stage.record({}, {0, 1, 0}, 64, 0.1f, 2);
    EXPECT_EQ(a.radiance, b.radiance);
    EXPECT_EQ(a.surfels.corners, b.surfels.corners);
    EXPECT_NE(a.radiance, c.radiance);
}

}  // namespace
}  // namespace relumine
