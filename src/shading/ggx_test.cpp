// SPDX-License-Identifier: Apache-2.0
// GGX lobes: the bound on what they reflect, and two roughnesses.
#include "shading/ggx.hpp"

#include <gtest/gtest.h>

#include "shading/reflectance.hpp"
#include "tests/bsdfs.hpp"

namespace relumine {
namespace {

using namespace testing;  // of tests/bsdfs.hpp

TEST(Ggx, GrazingAlbedoIsAnUpperBoundOfTheLobes) {
    for (int i = 0; i <= 30; ++i)
        for (int j = 1; j <= 30; ++j) {
            const float alpha = std::max(sqr(static_cast<float>(i) / 30), smooth_alpha);
            const float cosine = sqr(static_cast<float>(j) / 30);
            const float lobe = lobe_albedo(direction(cosine, 0), ggx(alpha)).f90;
            EXPECT_GT(grazing_albedo(cosine, alpha), lobe - 0.006f) << alpha << " " << cosine;
        }
}

TEST(Ggx, GrazingAlbedoIsAnUpperBoundOfStretchedLobes) {
    double excess_of_mean = 0;
    for (const auto& [x, y] : {std::pair{1.0f, 0.3f}, {0.5f, 0.1f}, {0.3f, 0.002f}, {1.0f, 0.03f}})
        for (const float cosine : {0.02f, 0.1f, 0.5f})
            for (const float azimuth : {0.0f, 0.8f, pi / 2}) {
                const RoughConductor grazing{Spectrum{0}, ggx(x, y)};  // reflects Schlick's term alone
                const auto [lobe, error, count] = directional_albedo(grazing, direction(cosine, azimuth));
                EXPECT_GT(grazing_albedo(cosine, grazing.ggx), lobe - 5 * error - 0.002)
                    << x << " " << y << " " << cosine << " " << azimuth;
                excess_of_mean = std::max(excess_of_mean, lobe - grazing_albedo(cosine, grazing.ggx.alpha));
            }
    EXPECT_GT(excess_of_mean, 0.02);  // the mean α would not do
}

TEST(Ggx, StretchedLayersOverWhiteReflectNoMoreThanArrives) {
    Extremes coats;
    for (const auto& [x, y] : {std::pair{1.0f, 0.3f}, {0.6f, 0.05f}, {0.2f, 0.002f}})
        for (const float azimuth : {0.0f, 0.8f, pi / 2})
            coats.add(layered(coated({Spectrum{1}, Spectrum{0.04f}, Spectrum{1}, Spectrum{0.04f}, Spectrum{1},
                                      ggx(x, y)},
                                     0, 1)),
                      azimuth);
    EXPECT_LT(coats.most, 1.001);
    EXPECT_GT(coats.least, 0.3);  // at grazing views the bound takes more than some azimuths reflect
}

LocalDir quarter_turn(LocalDir w) { return {{-w.v.y, w.v.x, w.v.z}}; }

TEST(Ggx, AQuarterTurnSwapsTheRoughnesses) {
    const auto difference = [](const Bsdf& a, const Bsdf& b) {
        float most = 0;
        for (std::uint32_t i = 0; i < 500; ++i) {
            const LocalDir w_out = direction(0.05f + 0.9f * random_numbers(7, i).lobe, 1),
                           w_in = direction(0.02f + 0.9f * random_numbers(8, i).lobe,
                                            2 * pi * random_numbers(8, i).direction.x);
            const BsdfValue here = evaluate(a, w_out, w_in),
                            there = evaluate(b, quarter_turn(w_out), quarter_turn(w_in));
            most = std::max({most, std::abs(here.value.g - there.value.g) / std::max(here.value.g, 1e-3f),
                             std::abs(here.pdf - there.pdf) / std::max(here.pdf, 1e-3f)});
        }
        return most;
    };
    const Ggx lobe = ggx(0.4f, 0.1f), turned = ggx(0.1f, 0.4f);
    EXPECT_LT(difference(RoughConductor{Spectrum{1}, lobe}, RoughConductor{Spectrum{1}, turned}), 1e-4f);
    EXPECT_LT(difference(RoughDielectric{1.5f, Spectrum{1}, false, lobe},
                         RoughDielectric{1.5f, Spectrum{1}, false, turned}),
              1e-4f);
    EXPECT_GT(difference(RoughConductor{Spectrum{1}, lobe}, RoughConductor{Spectrum{1}, lobe}), 0.5f);
}

TEST(Ggx, EqualRoughnessesAreTheIsotropicLobe) {
    for (const float alpha : {0.002f, 0.1f, 0.77f}) {
        const Ggx lobe = ggx(alpha, alpha), near = ggx(alpha, alpha * 1.0001f);
        EXPECT_FALSE(is_anisotropic(lobe));
        EXPECT_EQ(lobe.alpha, alpha);
        EXPECT_TRUE(is_anisotropic(near));
        for (std::uint32_t i = 0; i < 100; ++i) {
            const LocalDir w_out = direction(0.05f + 0.9f * random_numbers(9, i).lobe, 1);
            const LocalDir w_in = sample_reflection(lobe, w_out, random_numbers(9, i).direction);
            if (cos_theta(w_in) <= 0) continue;
            const BsdfValue a = evaluate(RoughConductor{Spectrum{1}, lobe}, w_out, w_in),
                            b = evaluate(RoughConductor{Spectrum{1}, near}, w_out, w_in);
            EXPECT_NEAR(a.value.g, b.value.g, 1e-3f * a.value.g);
            EXPECT_NEAR(a.pdf, b.pdf, 1e-3f * a.pdf);
        }
    }
}

TEST(Ggx, StretchedFacetsCoverTheSurface) {  // ∫ D cos θ dω = 1
    for (const auto& [x, y] : {std::pair{0.5f, 0.1f}, {0.2f, 0.9f}, {1.0f, 1.0f}}) {
        const Density facets = [&](LocalDir m) {
            return m.v.z > 0 ? double{ggx_density(ggx(x, y), m) * m.v.z} : 0.0;
        };
        double area = 0;
        for (int t = 0; t < theta_cells; ++t)
            for (int p = 0; p < phi_cells; ++p) area += cell_integral(facets, t, p);
        EXPECT_NEAR(area, 1, 1e-3) << x << " " << y;
    }
}

TEST(Ggx, FacetsLeanFurtherAlongTheRougherAxis) {
    const Ggx lobe = ggx(0.5f, 0.1f);
    EXPECT_GT(ggx_density(lobe, direction(0.9f, 0)), 50 * ggx_density(lobe, direction(0.9f, pi / 2)));
}

}  // namespace
}  // namespace relumine
