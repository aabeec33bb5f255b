// SPDX-License-Identifier: Apache-2.0
// Every BSDF: sample follows pdf, weight is f·cos/pdf, energy, reciprocity, white furnaces.
#include "shading/bsdf.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <string>
#include <string_view>

#include "shading/reflectance.hpp"
#include "tests/bsdfs.hpp"

namespace relumine {
namespace {

using namespace testing;  // of tests/bsdfs.hpp

constexpr int draws = 400'000;

struct NamedBsdf {
    const char* name;
    Bsdf bsdf;
};

/// How many there are, known without making them: sheen fills a table, which every start of the test program
/// would wait for.
constexpr std::size_t rough_bsdf_count = 21;

const std::vector<NamedBsdf>& rough_bsdfs() {
    static const std::vector<NamedBsdf> all{
        {"lambert", Lambert{Spectrum{0.8f}}},
        {"conductor .09", RoughConductor{Spectrum{0.9f}, ggx(0.09f)}},
        {"conductor .3", RoughConductor{Spectrum{0.9f, 0.6f, 0.3f}, ggx(0.3f)}},
        {"conductor 1", RoughConductor{Spectrum{1}, ggx(1)}},
        {"conductor separable", RoughConductor{Spectrum{1}, {0.5f, Masking::separable}}},
        {"conductor stretched", RoughConductor{Spectrum{0.9f, 0.6f, 0.3f}, ggx(0.5f, 0.12f)}},
        {"conductor stretched, separable",
         RoughConductor{Spectrum{1}, make_ggx(0.15f, 0.8f, Masking::separable)}},
        {"dielectric stretched", RoughDielectric{1.5f, Spectrum{1}, false, ggx(0.12f, 0.4f)}},
        {"layered stretched", MetallicRoughness{Spectrum{0.5f}, Spectrum{0.04f}, Spectrum{1}, Spectrum{0.04f},
                                                Spectrum{1}, ggx(0.6f, 0.15f)}},
        {"coated diffuse stretched", CoatedDiffuse{Spectrum{0.4f, 0.3f, 0.1f}, 1.5f, ggx(0.15f, 0.5f)}},
        {"dielectric into", RoughDielectric{1.5f, Spectrum{1}, false, ggx(0.2f)}},
        {"dielectric out of", RoughDielectric{1 / 1.5f, Spectrum{1}, false, ggx(0.4f)}},
        {"dielectric thin", RoughDielectric{1.5f, Spectrum{0.9f}, true, ggx(0.3f)}},
        {"layered", MetallicRoughness{Spectrum{0.5f}, Spectrum{0.04f}, Spectrum{1}, Spectrum{0.04f},
                                      Spectrum{1}, ggx(0.25f)}},
        {"layered metal", MetallicRoughness{Spectrum{0.3f}, Spectrum{0}, Spectrum{0}, Spectrum{0.4f},
                                            Spectrum{0.5f}, ggx(0.2f)}},
        {"coated diffuse", CoatedDiffuse{Spectrum{0.4f, 0.3f, 0.1f}, 1.5f, ggx(0.25f)}},
        {"diffuse transmission", DiffuseTransmission{Spectrum{0.3f}, Spectrum{0.5f, 0.4f, 0.2f}}},
        {"clear coat", layered(coated(plastic(Spectrum{0.7f, 0.4f, 0.2f}, 0.4f), 1, 0.15f))},
        {"clear coat on metal",
         layered(coated({{}, {}, {}, Spectrum{0.9f, 0.6f, 0.3f}, Spectrum{1}, ggx(0.3f)}, 0.7f, 0.12f))},
        {"sheen", layered(with_sheen(coated(plastic(Spectrum{0.5f, 0.3f, 0.2f}, 0.5f), 0, 1),
                                     Spectrum{0.9f, 0.6f, 0.3f}, 0.3f))},
        {"sheen under coat", layered(with_sheen(coated(plastic(Spectrum{0.3f}, 0.6f), 0.8f, 0.2f),
                                                Spectrum{0.5f, 0.8f, 0.9f}, 0.6f))},
    };
    return all;
}

constexpr std::array view_cosines{0.98f, 0.6f, 0.15f};

using Sampler = std::function<std::optional<LocalDir>(BsdfRandom)>;

/// χ² of `draws` samples over the sphere against a density; what is absorbed is a cell of its own.
double chi_square(const Sampler& sampler, const Density& density) {
    std::vector<double> observed(theta_cells * phi_cells + 1), expected(observed.size());
    for (std::uint32_t i = 0; i < draws; ++i) {
        const auto w = sampler(random_numbers(1, i));
        if (!w) {
            ++observed.back();
            continue;
        }
        double phi = std::atan2(w->v.y, w->v.x) / (2 * 3.14159265358979);
        if (phi < 0) phi += 1;
        const double theta = std::acos(std::clamp(double{w->v.z}, -1.0, 1.0)) / 3.14159265358979;
        const int t = std::clamp(static_cast<int>(theta * theta_cells), 0, theta_cells - 1);
        const int p = std::clamp(static_cast<int>(phi * phi_cells), 0, phi_cells - 1);
        ++observed[static_cast<std::size_t>(t * phi_cells + p)];
    }
    double total = 0;
    for (int t = 0; t < theta_cells; ++t)
        for (int p = 0; p < phi_cells; ++p)
            total += expected[static_cast<std::size_t>(t * phi_cells + p)] =
                draws * cell_integral(density, t, p);
    expected.back() = std::max(0.0, draws - total);
    return testing::chi_square_p(observed, expected);
}

Sampler sampler_of(const Bsdf& bsdf, LocalDir w_out) {
    return [=](BsdfRandom u) -> std::optional<LocalDir> {
        const auto s = sample(bsdf, w_out, u);
        return s ? std::optional(s->w_in) : std::nullopt;
    };
}

Density density_of(const Bsdf& bsdf, LocalDir w_out) {
    return [=](LocalDir w_in) { return double{pdf(bsdf, w_out, w_in)}; };
}

TEST(Sampling, SinesOfTurnsAreThoseOfTheLibrary) {
    for (int i = 0; i <= 100'000; ++i) {
        const float turns = static_cast<float>(i) / 100'000;
        const double angle = 2 * 3.14159265358979323846 * static_cast<double>(turns);
        const auto [sine, cosine] = sine_cosine_of_turns(turns);
        ASSERT_NEAR(sine, std::sin(angle), 2e-7) << turns;
        ASSERT_NEAR(cosine, std::cos(angle), 2e-7) << turns;
    }
}

/// One test for each: together they take seconds.
class RoughBsdfs : public ::testing::TestWithParam<std::size_t> {
  protected:
    const NamedBsdf& named = rough_bsdfs()[GetParam()];
};
INSTANTIATE_TEST_SUITE_P(Each, RoughBsdfs, ::testing::Range(std::size_t{0}, rough_bsdf_count));

TEST(Bsdf, AllRoughOnesAreTested) { EXPECT_EQ(rough_bsdfs().size(), rough_bsdf_count); }

TEST_P(RoughBsdfs, SamplesFollowThePdf) {  // χ², α = 1e-6 in all
    SCOPED_TRACE(named.name);
    const double level =
        testing::sidak(1e-6, static_cast<double>(rough_bsdfs().size() * view_cosines.size()));
    for (const float cosine : view_cosines) {
        const LocalDir w_out = direction(cosine, 0.7f);
        EXPECT_GT(chi_square(sampler_of(named.bsdf, w_out), density_of(named.bsdf, w_out)), level) << cosine;
    }
}

TEST_P(RoughBsdfs, ChiSquareCatchesSamplersOfAnotherView) {
    // Neither what is diffuse nor α = 1 (where bounded sampling is uniform) depends on the view.
    const std::string_view name = named.name;
    SCOPED_TRACE(name);
    const bool depends = name != "lambert" && name != "conductor 1" && name != "diffuse transmission";
    const LocalDir w_out = direction(0.6f, 0.7f),
                   tilted = direction(std::cos(std::acos(0.6f) + 0.1f), 0.7f);  // 6° off
    EXPECT_EQ(chi_square(sampler_of(named.bsdf, tilted), density_of(named.bsdf, w_out)) < 1e-6, depends);
}

TEST(Bsdf, ChiSquareCatchesWrongSamplers) {
    const Sampler uniform = [](BsdfRandom u) {
        return std::optional(direction(u.direction.x, 2 * pi * u.direction.y));
    };
    EXPECT_LT(chi_square(uniform, density_of(Lambert{Spectrum{1}}, direction(0.6f, 0))), 1e-6);
    const LocalDir at_quarter = direction(0.6f, 0.7f);
    const RoughConductor stretched{Spectrum{1}, ggx(0.5f, 0.12f)};
    for (const Ggx& other : {ggx(0.12f, 0.5f), ggx(stretched.ggx.alpha), ggx(0.5f, 0.16f)})
        EXPECT_LT(chi_square(sampler_of(RoughConductor{Spectrum{1}, other}, at_quarter),
                             density_of(stretched, at_quarter)),
                  1e-6)
            << alpha_x(other) << " " << alpha_y(other);
    const DiffuseTransmission through{Spectrum{0.3f}, Spectrum{0.5f}},
        swapped{Spectrum{0.5f}, Spectrum{0.3f}};
    const LocalDir w_out = direction(0.6f, 0.7f);
    EXPECT_LT(chi_square(sampler_of(swapped, w_out), density_of(through, w_out)), 1e-6);
}

TEST(Bsdf, WeightIsEvalOverPdf) {
    for (const auto& [name, bsdf] : rough_bsdfs())
        for (std::uint32_t i = 0; i < 2000; ++i) {
            const LocalDir w_out =
                direction(0.05f + 0.9f * unit_float(static_cast<std::uint32_t>(mix(i))), 1);
            const auto s = sample(bsdf, w_out, random_numbers(2, i));
            if (!s) continue;
            EXPECT_FALSE(s->delta);
            EXPECT_NEAR(s->pdf / pdf(bsdf, w_out, s->w_in), 1, 1e-3) << name;
            const Spectrum f = eval(bsdf, w_out, s->w_in);
            EXPECT_NEAR(s->weight.g * s->pdf, f.g, 1e-3 * f.g + 1e-7) << name;
        }
}

TEST(Bsdf, NeverReflectsMoreThanArrives) {
    for (const auto& [name, bsdf] : rough_bsdfs())
        for (const float cosine : view_cosines) {
            const auto [mean, error, count] = directional_albedo(bsdf, direction(cosine, 0));
            EXPECT_LT(mean, 1 + 5 * error + 1e-4) << name << " at " << cosine;
            EXPECT_GT(mean, 0.3) << name << " at " << cosine;
        }
}

TEST(Bsdf, SamplingAndEvaluationGiveTheSameAlbedo) {
    for (const auto& [name, bsdf] : rough_bsdfs()) {
        const LocalDir w_out = direction(0.6f, 0.7f);
        double integral = 0;
        const Density f = [&](LocalDir w_in) {
            const auto eta2 = [&] {
                const auto* glass = std::get_if<RoughDielectric>(&bsdf);
                return glass && !glass->thin && w_in.v.z < 0 ? sqr(glass->eta) : 1.0f;
            };
            return double{eval(bsdf, w_out, w_in).r} * eta2();
        };
        for (int t = 0; t < theta_cells; ++t)
            for (int p = 0; p < phi_cells; ++p) integral += cell_integral(f, t, p);
        const auto [mean, error, count] = directional_albedo(bsdf, w_out);
        EXPECT_NEAR(mean, integral, 5 * error + 2e-3) << name;
    }
}

TEST(Bsdf, ReflectionIsReciprocal) {
    const LocalDir a = direction(0.8f, 0.3f), b = direction(0.35f, 2.1f);
    for (const auto& [name, bsdf] : rough_bsdfs()) {
        const float forward = eval(bsdf, a, b).g / cos_theta(b), backward = eval(bsdf, b, a).g / cos_theta(a);
        EXPECT_NEAR(forward, backward, 1e-4f * forward + 1e-7f) << name;
    }
}

TEST(Bsdf, SmoothGlassConservesEnergy) {
    for (const float eta : {1.5f, 1 / 1.5f, 1.0f})
        for (const bool thin : {false, true})
            for (const float cosine : view_cosines) {
                const auto [mean, error, count] =
                    directional_albedo(SmoothDielectric{eta, Spectrum{1}, thin}, direction(cosine, 0));
                EXPECT_NEAR(mean, 1, 1e-4 + 0 * error) << eta << " " << cosine;
            }
}

TEST(Bsdf, SmoothCoatSplitsIntoDeltaAndDiffuse) {
    const MetallicRoughness coat{Spectrum{1}, Spectrum{0.04f},   Spectrum{1}, Spectrum{0.04f},
                                 Spectrum{1}, ggx(smooth_alpha), true};
    const LocalDir w_out = direction(0.7f, 0);
    double delta = 0, diffuse = 0;
    constexpr int n = 100'000;
    for (std::uint32_t i = 0; i < n; ++i)
        if (const auto s = sample(coat, w_out, random_numbers(4, i)))
            (s->delta ? delta : diffuse) += s->weight.r / n;
    EXPECT_NEAR(delta, schlick(Spectrum{0.04f}, Spectrum{1}, 0.7f).r, 2e-3);
    const double rest = directional_albedo(without_delta(coat), w_out).mean;
    EXPECT_NEAR(diffuse, rest, 0.01);
    EXPECT_GT(delta_probability(coat, w_out), 0);
    EXPECT_EQ(delta_probability(without_delta(coat), w_out), 0);
}

TEST(Bsdf, LayersOverWhiteReflectNoMoreThanArrives) {
    Extremes coats, clearcoats, sheens;
    for (const float alpha : {0.002f, 0.03f, 0.15f, 0.4f, 1.0f}) {
        CoatedLayers white = coated(plastic(Spectrum{1}, alpha), 0, 1);
        coats.add(layered(white));
        white.clearcoat = 1;
        for (const float over : {0.004f, 0.3f}) {
            white.clearcoat_ggx = ggx(over);
            clearcoats.add(layered(white));
        }
        const CoatedLayers cloth =
            with_sheen(coated(plastic(Spectrum{1}, 0.5f), 0, 1), Spectrum{1}, std::max(alpha, 0.01f));
        sheens.add(layered(cloth));
    }
    EXPECT_LT(coats.most, 1.001);
    EXPECT_GT(coats.least, 0.8);  // single scattering and the bound's slack, both at grazing views
    EXPECT_LT(clearcoats.most, 1.001);
    EXPECT_GT(clearcoats.least, 0.8);
    EXPECT_LT(sheens.most, 1.003);  // interpolation in the table
    EXPECT_GT(sheens.least, 0.8);
}

TEST(Bsdf, FurnaceCatchesCoatsThatTakeNothing) {
    CoatedLayers white = coated(plastic(Spectrum{1}, 0.3f), 1, 0.1f);
    white.base.coat_f0 = white.base.coat_f90 = {};  // the base does not lose what the coat reflects
    Extremes gained;
    gained.add(layered(white));
    EXPECT_GT(gained.most, 1.03);
}

TEST(Bsdf, SmoothClearCoatSplitsIntoDeltaAndTheRest) {
    CoatedLayers lacquer = coated(plastic(Spectrum{0.8f, 0.3f, 0.2f}, 0.3f), 1, smooth_alpha);
    lacquer.clearcoat_smooth = true;
    lacquer = layered(lacquer);
    const LocalDir w_out = direction(0.5f, 0.4f);
    double delta = 0, rest = 0;
    constexpr int n = 100'000;
    for (std::uint32_t i = 0; i < n; ++i)
        if (const auto s = sample(lacquer, w_out, random_numbers(5, i)))
            (s->delta ? delta : rest) += s->weight.r / n;
    EXPECT_NEAR(delta, schlick(Spectrum{0.04f}, Spectrum{1}, 0.5f).r, 2e-3);
    const Bsdf without = without_delta(lacquer);
    EXPECT_NEAR(rest, directional_albedo(without, w_out).mean, 0.01);
    EXPECT_GT(delta_probability(lacquer, w_out), 0.01f);
    EXPECT_EQ(delta_probability(without, w_out), 0);
}

TEST(Fresnel, MatchesClosedForms) {
    EXPECT_NEAR(fresnel_dielectric(1, 1.5f), 0.04f, 1e-6f);
    EXPECT_NEAR(fresnel_dielectric(std::cos(std::atan(1.5f)), 1.5f),
                0.5f * sqr((sqr(1.5f) - 1) / (sqr(1.5f) + 1)), 1e-5f);  // Brewster
    EXPECT_EQ(fresnel_dielectric(0.5f, 1 / 1.5f), 1);                   // total reflection
    EXPECT_NEAR(fresnel_dielectric(0.3f, 1), 0, 1e-6f);
}

TEST(Refraction, FollowsSnell) {
    const LocalDir w_out = direction(0.6f, 0.4f);
    const auto s = sample(SmoothDielectric{1.5f, Spectrum{1}, false}, w_out, {0.99f, {0.5f, 0.5f}});
    ASSERT_TRUE(s && s->delta);
    EXPECT_LT(s->w_in.v.z, 0);
    EXPECT_NEAR(std::hypot(s->w_in.v.x, s->w_in.v.y) * 1.5f, std::hypot(w_out.v.x, w_out.v.y), 1e-5f);
    EXPECT_NEAR(s->weight.r, 1 / 2.25f, 1e-5f);
}

TEST(Sampling, SineAndCosineOfAnOctantAreExactToFloats) {
    for (int i = -1000; i <= 1000; ++i) {
        const float x = pi / 4 * static_cast<float>(i) / 1000;
        const auto [sine, cosine] = sine_cosine_of_octant(x);
        EXPECT_NEAR(sine, std::sin(double{x}), 1e-7);
        EXPECT_NEAR(cosine, std::cos(double{x}), 1e-7);
    }
}

TEST(Bsdf, EvaluateIsEvalAndPdf) {
    const auto differences = [](const Bsdf& bsdf, float turned) {  // `turned` shifts eval's and pdf's azimuth
        int count = 0;
        for (std::uint32_t i = 0; i < 200; ++i) {
            const auto [z, u] = random_numbers(3, i);
            const LocalDir w_out = direction(0.05f + 0.95f * z, 1);
            const LocalDir w_in = direction(2 * u.x - 1, 2 * pi * u.y),
                           other = direction(2 * u.x - 1, 2 * pi * u.y + turned);
            const BsdfValue both = evaluate(bsdf, w_out, w_in);
            const Spectrum value = eval(bsdf, w_out, other);
            const float density = pdf(bsdf, w_out, other);
            const bool same = std::abs(both.pdf - density) <= 1e-6f * density
                              && max_component(both.value - value) <= 1e-6f * max_component(value)
                              && max_component(value - both.value) <= 1e-6f * max_component(value);
            count += same ? 0 : 1;
        }
        return count;
    };
    for (const auto& [name, bsdf] : rough_bsdfs()) EXPECT_EQ(differences(bsdf, 0), 0) << name;
    EXPECT_EQ(differences(Mirror{Spectrum{1}}, 0), 0);
    EXPECT_GT(differences(RoughConductor{Spectrum{1}, ggx(0.3f)}, 0.1f), 50);
}

/// Rounding makes cosines a little more than 1. The sheen's fit had a root of less than nothing there.
TEST(Bsdf, IsFiniteStraightAbove) {
    for (const auto& [name, bsdf] : rough_bsdfs())
        for (const float cosine : {1.0f, std::nextafter(1.0f, 2.0f), 1 + 1e-6f})
            for (const LocalDir other : {direction(0.4f, 1), LocalDir{{0, 0, cosine}}}) {
                const LocalDir above{{0, 0, cosine}};
                EXPECT_TRUE(is_finite(eval(bsdf, above, other))) << name;
                EXPECT_TRUE(is_finite(eval(bsdf, other, above))) << name;
                EXPECT_TRUE(std::isfinite(pdf(bsdf, above, other))) << name;
                EXPECT_TRUE(std::isfinite(pdf(bsdf, other, above))) << name;
            }
}

}  // namespace
}  // namespace relumine
