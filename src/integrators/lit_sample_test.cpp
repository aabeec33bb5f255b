// SPDX-License-Identifier: Apache-2.0
// Which samples of a pixel share an integral.
#include "integrators/lit_sample.hpp"

#include <gtest/gtest.h>

namespace relumine {
namespace {

/// A sample on the ground, with a layered surface.
struct GroundSample {
    GBufferPixel pixel;
    LitSample lit;

    GroundSample() {
        pixel.cache.gather.frame = frame_around({0, 0, 1});
        pixel.cache.footprint = 0.01f;
        lit.bsdf.diffuse = {0.5f, 0.4f, 0.3f};
        lit.bsdf.specular_f0 = Spectrum{0.04f};
        lit.bsdf.specular_f90 = Spectrum{1};
        lit.bsdf.ggx = {0.3f, Masking::correlated};
        lit.bsdf.specular = true;
        lit.bsdf.shading_x = {1, 0, 0};
        lit.bsdf.shading_y = {0, 1, 0};
        lit.bsdf.shading_z = {0, 0, 1};
    }
    [[nodiscard]] LitSample sample() const {
        LitSample s = lit;
        s.pixel = &pixel;
        return s;
    }
};

TEST(LitSample, ColourMayDifferUnlessIntegralsAreExact) {
    const GroundSample a;
    GroundSample b;
    EXPECT_TRUE(shares_integral(a.sample(), b.sample(), true));
    b.lit.bsdf.diffuse = {0.1f, 0.6f, 0.3f};
    EXPECT_TRUE(shares_integral(a.sample(), b.sample(), false));
    EXPECT_FALSE(shares_integral(a.sample(), b.sample(), true));
    EXPECT_NEAR(diffuse_ratio(a.sample(), b.sample()).r, 0.2f, 1e-6f);
    EXPECT_NEAR(diffuse_ratio(a.sample(), b.sample()).g, 1.5f, 1e-6f);
    GroundSample black;
    black.lit.bsdf.diffuse = {};
    EXPECT_FALSE(shares_integral(black.sample(), a.sample(), false));
    EXPECT_TRUE(shares_integral(a.sample(), black.sample(), false));
    EXPECT_EQ(diffuse_ratio(a.sample(), black.sample()), Spectrum{});
}

TEST(LitSample, LobesPlacesAndNormalsMayNot) {
    const GroundSample a;
    const auto shares = [&](const auto& change) {
        GroundSample b;
        change(b);
        return shares_integral(a.sample(), b.sample(), false);
    };
    EXPECT_TRUE(shares([](GroundSample& b) { b.pixel.cache.gather.position = {3, 2, 0.005f}; }));
    EXPECT_FALSE(shares([](GroundSample& b) { b.pixel.cache.gather.position = {0, 0, 0.02f}; }));
    EXPECT_FALSE(shares([](GroundSample& b) { b.pixel.cache.gather.depth = 1; }));
    EXPECT_FALSE(shares([](GroundSample& b) { b.lit.bsdf.shading_z = normalize({0.1f, 0, 1}); }));
    EXPECT_FALSE(shares([](GroundSample& b) { b.lit.bsdf.ggx.alpha = 0.31f; }));
    EXPECT_FALSE(shares([](GroundSample& b) { b.lit.bsdf.specular_f0 = Spectrum{0.05f}; }));
    EXPECT_FALSE(shares([](GroundSample& b) { b.lit.bsdf.specular = false; }));
    EXPECT_FALSE(shares([](GroundSample& b) { b.lit.bsdf.coated = true; }));
}

TEST(LitSample, LayersMayNotDifferEither) {
    GroundSample a;
    OverLayers& over = a.lit.bsdf.over;
    over.clearcoat = over.clearcoat_lobe = 0.8f;
    over.clearcoat_alpha = 0.2f;
    over.sheen = 0.5f;
    over.sheen_lobe = {0.5f, 0.4f, 0.3f};
    over.sheen_alpha = 0.3f;
    const auto shares = [&](const auto& change) {
        GroundSample b = a;
        change(b.lit.bsdf.over);
        return shares_integral(a.sample(), b.sample(), false);
    };
    EXPECT_TRUE(shares([](OverLayers& o) { o.clearcoat = o.clearcoat_lobe = 0.801f; }));
    EXPECT_FALSE(shares([](OverLayers& o) { o.clearcoat = 0.7f; }));
    EXPECT_FALSE(shares([](OverLayers& o) { o.clearcoat_lobe = 0; }));
    EXPECT_FALSE(shares([](OverLayers& o) { o.clearcoat_alpha = 0.1f; }));
    EXPECT_FALSE(shares([](OverLayers& o) { o.sheen = 0.4f; }));
    EXPECT_FALSE(shares([](OverLayers& o) { o.sheen_lobe = {}; }));
    EXPECT_FALSE(shares([](OverLayers& o) { o.sheen_alpha = 0.5f; }));
    EXPECT_FALSE(shares([](OverLayers& o) { o.eta = 1.5f; }));
    EXPECT_FALSE(shares([](OverLayers& o) { o = {}; }));
    GroundSample matte = a;
    matte.lit.bsdf = without_lobes(a.lit.bsdf);
    matte.lit.bsdf.diffuse = {0.1f, 0.6f, 0.3f};
    GroundSample brown = matte;
    brown.lit.bsdf.diffuse = a.lit.bsdf.diffuse;
    EXPECT_TRUE(shares_integral(brown.sample(), matte.sample(), false));
    EXPECT_FALSE(shares_integral(brown.sample(), matte.sample(), true));
}

TEST(LitSample, PixelsShareWhatLooksAlikeFromBoth) {
    const GroundSample a;
    const auto alike = [&](float angle, float alpha) {
        GroundSample b, c = a;
        b.lit.bsdf.w_out = LocalDir{{std::sin(angle), 0, std::cos(angle)}};
        c.lit.bsdf.w_out = LocalDir{{0, 0, 1}};
        b.lit.bsdf.ggx.alpha = c.lit.bsdf.ggx.alpha = alpha;
        return seen_alike(c.sample(), b.sample());
    };
    EXPECT_TRUE(alike(0.002f, 0.3f));
    EXPECT_FALSE(alike(0.002f, 0.05f));
    EXPECT_FALSE(alike(0.02f, 0.3f));
    const auto alike_under_clearcoat = [&](float alpha) {
        GroundSample b = a;
        b.lit.bsdf.over.clearcoat = b.lit.bsdf.over.clearcoat_lobe = 1;
        b.lit.bsdf.over.clearcoat_alpha = alpha;
        GroundSample c = b;
        b.lit.bsdf.w_out = LocalDir{{std::sin(0.002f), 0, std::cos(0.002f)}};
        c.lit.bsdf.w_out = LocalDir{{0, 0, 1}};
        return seen_alike(c.sample(), b.sample());
    };
    EXPECT_TRUE(alike_under_clearcoat(0.3f));
    EXPECT_FALSE(alike_under_clearcoat(0.05f));
    GroundSample matte = a, turned = a;
    matte.lit.bsdf.specular = turned.lit.bsdf.specular = false;
    turned.lit.bsdf.w_out = LocalDir{{0.6f, 0, 0.8f}};
    EXPECT_TRUE(seen_alike(matte.sample(), turned.sample()));
}

TEST(LitSample, AMatteSurfaceSharesWhateverItsColour) {
    GroundSample a, b;
    a.lit.bsdf.specular = b.lit.bsdf.specular = false;
    b.lit.bsdf.diffuse = {0.25f, 0.2f, 0.6f};
    EXPECT_TRUE(shares_integral(a.sample(), b.sample(), true));
    EXPECT_EQ(diffuse_ratio(a.sample(), b.sample()), (Spectrum{0.5f, 0.5f, 2}));
}

}  // namespace
}  // namespace relumine
