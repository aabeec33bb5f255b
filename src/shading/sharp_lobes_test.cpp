// SPDX-License-Identifier: Apache-2.0
// What is taken out of a BSDF and what stays must make the whole.
#include "shading/sharp_lobes.hpp"

#include <gtest/gtest.h>

#include <string>

#include "base/hash.hpp"

namespace relumine {
namespace {

constexpr float limit = 0.05f;

MetallicRoughness plastic(float alpha) {
    return {{0.5f, 0.2f, 0.1f}, Spectrum{0.04f}, Spectrum{1}, Spectrum{0.04f}, Spectrum{1}, {alpha}, false};
}
CoatedLayers layers(float base_alpha, float clearcoat_alpha) {
    CoatedLayers b;
    b.base = plastic(base_alpha);
    b.clearcoat = 0.8f;
    b.clearcoat_ggx.alpha = clearcoat_alpha;
    b.sheen = {0.2f, 0.1f, 0.3f};
    b.sheen_alpha = 0.4f;
    return layered(b);
}
CoatedDiffuse lacquer(float alpha) { return {{0.6f, 0.3f, 0.1f}, 1.5f, {alpha}, false, true}; }

Point2 random_point(std::uint64_t i) {
    return {unit_float(static_cast<std::uint32_t>(hash(i, 1))),
            unit_float(static_cast<std::uint32_t>(hash(i, 2)))};
}

struct Split {
    std::string name;
    Bsdf bsdf;
};
std::vector<Split> with_sharp_lobes() {
    return {{"metal", RoughConductor{{0.9f, 0.6f, 0.3f}, {0.02f}}},
            {"plastic", plastic(0.03f)},
            {"lacquer", lacquer(0.02f)},
            {"clear coat", layers(0.4f, 0.01f)},
            {"base under a rough clear coat", layers(0.02f, 0.3f)},
            {"both", layers(0.04f, 0.02f)}};
}

TEST(SharpLobes, AreTakenFromWhatIsSharperThanTheLimit) {
    for (const Bsdf& bsdf :
         std::vector<Bsdf>{Lambert{{0.7f, 0.5f, 0.2f}}, plastic(0.06f), lacquer(0.1f), layers(0.1f, 0.2f),
                           Mirror{Spectrum{0.9f}}, RoughDielectric{1.5f, Spectrum{1}, false, {0.02f}}})
        EXPECT_FALSE(sharp_lobes(bsdf, limit)) << bsdf.index();
    for (const auto& [name, bsdf] : with_sharp_lobes()) {
        EXPECT_TRUE(sharp_lobes(bsdf, limit)) << name;
        EXPECT_FALSE(sharp_lobes(bsdf, 0.005f)) << name;
        EXPECT_FALSE(sharp_lobes(sharp_lobes(bsdf, limit)->rest, limit)) << name;
    }
}

TEST(SharpLobes, LeaveNothingOfMetal) {
    EXPECT_TRUE(is_black(sharp_lobes(RoughConductor{{0.9f, 0.6f, 0.3f}, {0.02f}}, limit)->rest));
    MetallicRoughness metal = plastic(0.02f);
    metal.diffuse = Spectrum{};
    EXPECT_TRUE(is_black(sharp_lobes(metal, limit)->rest));
    CoatedLayers lacquered = layers(0.02f, 0.02f);
    lacquered.base.diffuse = lacquered.sheen = Spectrum{};
    EXPECT_TRUE(is_black(sharp_lobes(lacquered, limit)->rest));
    EXPECT_FALSE(is_black(sharp_lobes(plastic(0.02f), limit)->rest));
}

TEST(SharpLobes, AreTheWholeLessTheRest) {
    const LocalDir w_out{normalize(Vec3{0.5f, -0.2f, 0.7f})};
    for (const auto& [name, bsdf] : with_sharp_lobes()) {
        const SharpLobes lobes = *sharp_lobes(bsdf, limit);
        for (std::uint64_t i = 0; i < 1000; ++i) {
            const LocalDir w_in =
                i % 2 == 0 ? cosine_hemisphere(random_point(i))
                           : sample_reflection({0.03f}, w_out, random_point(i));  // where the lobes are
            if (!(cos_theta(w_in) > 0)) continue;
            const Spectrum whole = eval(bsdf, w_out, w_in),
                           sum = eval(lobes.rest, w_out, w_in) + evaluate(lobes, bsdf, w_out, w_in).value;
            ASSERT_NEAR(sum.r, whole.r, 1e-5f * whole.r) << name;
            ASSERT_NEAR(sum.g, whole.g, 1e-5f * whole.g) << name;
            ASSERT_NEAR(sum.b, whole.b, 1e-5f * whole.b) << name;
        }
    }
}

/// What the lobes reflect of light from everywhere, by drawing from them, is what the whole does less the
/// rest, and no draw weighs much more than the others: they are drawn where they are.
TEST(SharpLobes, AreDrawnWhereTheyAre) {
    const LocalDir w_out{normalize(Vec3{0.5f, -0.2f, 0.7f})};
    constexpr int draws = 20000;
    for (const auto& [name, bsdf] : with_sharp_lobes()) {
        const SharpLobes lobes = *sharp_lobes(bsdf, limit);
        double sum = 0, whole_less_rest = 0;
        float heaviest = 0;
        for (std::uint64_t i = 0; i < draws; ++i) {
            const BsdfRandom u{unit_float(static_cast<std::uint32_t>(hash(i, 3))), random_point(i)};
            if (const auto drawn = sample(lobes.drawn, w_out, u)) {
                const BsdfValue value = evaluate(lobes, bsdf, w_out, drawn->w_in);
                ASSERT_FLOAT_EQ(value.pdf, pdf(lobes.drawn, w_out, drawn->w_in));
                sum += value.value.r / value.pdf;
                heaviest = std::max(heaviest, value.value.r / value.pdf);
            }
            if (const auto drawn = sample(bsdf, w_out, u))
                whole_less_rest +=
                    drawn->weight.r
                    * (1 - eval(lobes.rest, w_out, drawn->w_in).r / eval(bsdf, w_out, drawn->w_in).r);
        }
        EXPECT_NEAR(sum, whole_less_rest, 0.05 * whole_less_rest) << name;
        EXPECT_LT(heaviest, 3 * sum / draws) << name;
    }
}

}  // namespace
}  // namespace relumine
