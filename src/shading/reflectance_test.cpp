// SPDX-License-Identifier: Apache-2.0
// Directional albedos against Monte Carlo integrals of the BSDFs that they stand for.
#include "shading/reflectance.hpp"

#include <gtest/gtest.h>

#include "base/sample_stream.hpp"

namespace relumine {
namespace {

LocalDir view(float cosine) { return {{std::sqrt(1 - sqr(cosine)), 0, cosine}}; }

/// ∫ f·|cos θ| dω by its own samples.
Spectrum albedo_by_sampling(const Bsdf& bsdf, LocalDir w_out) {
    constexpr std::uint32_t draws = 1 << 16;
    Spectrum sum;
    for (std::uint32_t i = 0; i < draws; ++i) {
        const SampleStream stream{7, i, draws, PointSet::sobol};
        const auto drawn = sample(bsdf, w_out, {stream.next1(Dim::lobe), stream.next2(Dim::direction)});
        if (drawn) sum += drawn->weight;
    }
    return sum / draws;
}

MetallicRoughness layered(float alpha) {
    return {Spectrum{0.8f, 0.5f, 0.2f},   Spectrum{0.04f}, Spectrum{1},
            Spectrum{0.1f, 0.08f, 0.05f}, Spectrum{1},     {alpha, Masking::correlated}};
}

void expect_near(Spectrum a, Spectrum b, float tolerance) {
    EXPECT_NEAR(a.r, b.r, tolerance);
    EXPECT_NEAR(a.g, b.g, tolerance);
    EXPECT_NEAR(a.b, b.b, tolerance);
}

TEST(Reflectance, PartsAddUpToTheWhole) {
    for (const float alpha : {0.03f, 0.1f, 0.3f, 0.7f, 1.0f})
        for (const float cosine : {0.15f, 0.4f, 0.77f, 0.99f}) {
            const Bsdf bsdf = layered(alpha);
            const LobeSplit split = split_lobes(bsdf, view(cosine));
            SCOPED_TRACE(testing::Message() << "alpha " << alpha << ", cosine " << cosine);
            expect_near(split.diffuse + split.glossy, albedo_by_sampling(bsdf, view(cosine)), 0.006f);
            ASSERT_TRUE(split.lobes.has_value());
            expect_near(split.glossy, albedo_by_sampling(*split.lobes, view(cosine)), 0.006f);
        }
}

TEST(Reflectance, PartsOfCoatedLayersAddUpToTheWhole) {
    CoatedLayers layers;
    layers.base = layered(0.5f);
    layers.clearcoat = 0.8f;
    layers.clearcoat_ggx = {0.3f, Masking::correlated};
    layers.sheen = {0.3f, 0.2f, 0.1f};
    layers.sheen_alpha = 0.4f;
    for (const float cosine : {0.4f, 0.77f, 0.99f}) {
        const Bsdf bsdf = relumine::layered(layers);
        const LobeSplit split = split_lobes(bsdf, view(cosine));
        SCOPED_TRACE(testing::Message() << "cosine " << cosine);
        expect_near(split.diffuse + split.glossy, albedo_by_sampling(bsdf, view(cosine)), 0.015f);
        ASSERT_TRUE(split.lobes.has_value());
        expect_near(split.glossy, albedo_by_sampling(*split.lobes, view(cosine)), 0.015f);
    }
}

TEST(Reflectance, ConductorsAreAllLobe) {
    for (const Masking masking : {Masking::correlated, Masking::separable}) {
        const Bsdf bsdf = RoughConductor{Spectrum{0.9f, 0.6f, 0.3f}, {0.4f, masking}};
        const LobeSplit split = split_lobes(bsdf, view(0.5f));
        EXPECT_TRUE(is_black(split.diffuse));
        expect_near(split.glossy, albedo_by_sampling(bsdf, view(0.5f)), 0.006f);
    }
}

TEST(Reflectance, StretchedLobesDependOnTheAzimuth) {
    float least = 1, most = 0;
    for (const float azimuth : {0.0f, 0.8f, 1.57f})
        for (const float cosine : {0.15f, 0.4f, 0.77f, 0.99f}) {
            const float sine = std::sqrt(1 - sqr(cosine));
            const LocalDir w_out{{sine * std::cos(azimuth), sine * std::sin(azimuth), cosine}};
            MetallicRoughness bsdf = layered(0.5f);
            bsdf.ggx = make_ggx(0.8f, 0.1f, Masking::correlated);
            const LobeSplit split = split_lobes(bsdf, w_out);
            SCOPED_TRACE(testing::Message() << "azimuth " << azimuth << ", cosine " << cosine);
            expect_near(split.diffuse + split.glossy, albedo_by_sampling(bsdf, w_out), 0.02f);
            expect_near(split.glossy, albedo_by_sampling(*split.lobes, w_out), 0.02f);
            if (cosine == 0.15f)
                least = std::min(least, split.glossy.g), most = std::max(most, split.glossy.g);
        }
    EXPECT_GT(most, least + 0.05f);
}

TEST(Reflectance, MatteSurfacesHaveNoLobes) {
    const LobeSplit split = split_lobes(Lambert{Spectrum{0.3f}}, view(0.5f));
    EXPECT_EQ(split.diffuse, Spectrum{0.3f});
    EXPECT_FALSE(split.lobes.has_value());
}

TEST(Reflectance, ASmoothCoatIsADelta) {
    MetallicRoughness bsdf = layered(smooth_alpha);
    bsdf.smooth = true;
    const LobeSplit split = split_lobes(bsdf, view(0.6f));
    ASSERT_TRUE(split.lobes.has_value());
    EXPECT_EQ(split.alpha, 0);
    expect_near(split.glossy, albedo_by_sampling(*split.lobes, view(0.6f)),
                2e-4f);  // sampling chooses between lobes
    expect_near(split.diffuse, albedo_by_sampling(without_delta(bsdf), view(0.6f)), 0.006f);
}

TEST(Reflectance, GlassIsNotSplit) {
    const LobeSplit split = split_lobes(SmoothDielectric{}, view(0.6f));
    EXPECT_TRUE(split.transmits);
    EXPECT_TRUE(split.lobes.has_value());
}

}  // namespace
}  // namespace relumine
