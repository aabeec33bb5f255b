// SPDX-License-Identifier: Apache-2.0
// Guided scattering: what is drawn has the density that it says, of surfaces and of the sky.
#include "radiance/path_guide.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "base/sample_stream.hpp"
#include "radiance/arrival_map.hpp"
#include "tests/statistics.hpp"

namespace relumine {
namespace {

using testing::chi_square_p;

constexpr double false_positive_rate = 1e-6;  // of each χ² below; the numbers are fixed
constexpr std::uint32_t draws = 1 << 17;
constexpr std::size_t rings = 8, sectors = 16, bins = rings * sectors;  // of the upper hemisphere, by z and φ

/// Some light from everywhere, much of it from two places.
ArrivalMap window_and_patch() {
    std::vector<float> irradiance(ArrivalMap::cells, 0.2f);
    irradiance[7 * ArrivalMap::side + 12] = 20;
    irradiance[2 * ArrivalMap::side + 6] = 7;
    irradiance[5] = 0;
    return ArrivalMap(irradiance);
}

Vertex vertex_of(const Bsdf& bsdf) {
    Vertex v{{}, {normalize(Vec3{0.5f, -0.3f, 0.7f})}, bsdf};
    v.point.geometric_normal = normalize(Vec3{0.2f, 1, 0.1f});
    v.point.frame = frame_around(normalize(Vec3{0.25f, 1, 0.1f}));
    return v;
}

PlacedArrivals arrivals_of(const ArrivalMap& map) {
    return {&map, &map, 0.4f, frame_around(normalize(Vec3{0.2f, 1, 0.1f}))};
}

std::size_t bin_of(Vec3 w) {
    const float turns = std::atan2(w.y, w.x) * (0.5f * inv_pi) + 0.5f;
    const auto cell = [](float x, std::size_t n) {
        return std::min(static_cast<std::size_t>(std::max(0.0f, x) * static_cast<float>(n)), n - 1);
    };
    return cell(w.z, rings) * sectors + cell(turns, sectors);
}

/// What `pdf` expects in each bin of the frame's hemisphere.
template <typename Pdf>
std::vector<double> expected_counts(const Frame& frame, const Pdf& pdf) {
    constexpr std::size_t fine = 96;  // points along each side of a bin
    std::vector<double> counts(bins + 1);
    double all = 0;
    for (std::size_t i = 0; i < rings * fine; ++i)
        for (std::size_t j = 0; j < sectors * fine; ++j) {
            const float z = (static_cast<float>(i) + 0.5f) / static_cast<float>(rings * fine);
            const float phi = 2 * pi * (static_cast<float>(j) + 0.5f) / static_cast<float>(sectors * fine);
            const float r = std::sqrt(1 - z * z);
            const Vec3 w{r * std::cos(phi), r * std::sin(phi), z};
            const double share =
                double{pdf(frame.to_world({w}))} * 2 * double{pi} / static_cast<double>(bins * fine * fine);
            counts[bin_of(w)] += share * draws;
            all += share;
        }
    counts[bins] = std::max(0.0, 1 - all) * draws;  // drawn in vain
    return counts;
}

template <typename Draw>
std::vector<double> drawn_counts(const Frame& frame, const Draw& draw) {
    std::vector<double> counts(bins + 1);
    for (std::uint32_t i = 0; i < draws; ++i) {
        const std::optional<WorldDir> w = draw(SampleStream{7, i, draws, PointSet::independent});
        const float z = w ? dot(w->v, frame.n) : -1;
        counts[z > 0 ? bin_of(frame.to_local(*w).v) : bins] += 1;
    }
    return counts;
}

class PathGuideOf : public ::testing::TestWithParam<Bsdf> {};
INSTANTIATE_TEST_SUITE_P(Bsdfs, PathGuideOf,
                         ::testing::Values(Bsdf{Lambert{Spectrum{0.5f}}},
                                           Bsdf{MetallicRoughness{.diffuse = Spectrum{0.4f},
                                                                  .coat_f0 = Spectrum{0.04f},
                                                                  .coat_f90 = Spectrum{1},
                                                                  .specular_f0 = Spectrum{0.04f},
                                                                  .specular_f90 = Spectrum{1},
                                                                  .ggx = {.alpha = 0.3f}}}));

TEST_P(PathGuideOf, SampleFollowsPdf) {
    const ArrivalMap map = window_and_patch();
    const Vertex v = vertex_of(GetParam());
    const PathGuide guide(arrivals_of(map), v);
    const auto draw = [&](const SampleStream& s) -> std::optional<WorldDir> {
        const auto d = guide.sample(v, {s.next1(Dim::lobe), s.next2(Dim::direction)});
        if (!d) return {};
        return v.point.frame.to_world(d->w_in);
    };
    const auto bsdf_pdf = [&](WorldDir w) { return pdf(v.bsdf, v.w_out, v.point.frame.to_local(w)); };
    const std::vector<double> drawn = drawn_counts(v.point.frame, draw);
    EXPECT_GT(chi_square_p(drawn, expected_counts(v.point.frame,
                                                  [&](WorldDir w) { return guide.pdf(w, bsdf_pdf(w)); })),
              false_positive_rate);
    // The mutant believes in another share of guided directions.
    const PathGuide mutant(arrivals_of(map), v, 0.9f * PathGuide::usual_share);
    EXPECT_LT(chi_square_p(drawn, expected_counts(v.point.frame,
                                                  [&](WorldDir w) { return mutant.pdf(w, bsdf_pdf(w)); })),
              false_positive_rate);
}

TEST_P(PathGuideOf, ASamplesWeightIsValueOverDensity) {
    const ArrivalMap map = window_and_patch();
    const Vertex v = vertex_of(GetParam());
    const PathGuide guide(arrivals_of(map), v);
    for (std::uint32_t i = 0; i < 1000; ++i) {
        const SampleStream s{3, i, 1000, PointSet::independent};
        const auto d = guide.sample(v, {s.next1(Dim::lobe), s.next2(Dim::direction)});
        if (!d) continue;
        const BsdfValue bsdf = evaluate(v.bsdf, v.w_out, d->w_in);
        EXPECT_NEAR(d->pdf, guide.pdf(v.point.frame.to_world(d->w_in), bsdf.pdf), 1e-4f * d->pdf);
        EXPECT_NEAR(luminance(d->weight), luminance(bsdf.value) / d->pdf, 1e-4f);
    }
}

TEST(PathGuide, SkySamplesFollowTheirDensity) {
    const ArrivalMap map = window_and_patch();
    const Vertex v = vertex_of(Lambert{Spectrum{0.5f}});
    PlacedArrivals arrivals = arrivals_of(map);
    const auto draw = [&](const SampleStream& s) -> std::optional<WorldDir> {
        const auto w = map.sample(s.next2(Dim::light_point));
        if (!w) return {};
        return arrivals.frame.to_world(*w);
    };
    const std::vector<double> drawn = drawn_counts(arrivals.frame, draw);
    const PathGuide guide(arrivals, v);
    const auto expected = [&](float factor) {
        return expected_counts(arrivals.frame,
                               [&](WorldDir w) { return factor * guide.sky_pdf(w) / arrivals.sky_share; });
    };
    EXPECT_GT(chi_square_p(drawn, expected(1)), false_positive_rate);
    EXPECT_LT(chi_square_p(drawn, expected(0.97f)), false_positive_rate);
}

TEST(PathGuide, WithoutMapsThereIsTheBsdfAlone) {
    const ArrivalMap nothing(std::vector<float>(ArrivalMap::cells, 0.0f));
    EXPECT_TRUE(nothing.empty());
    const Vertex v = vertex_of(Lambert{Spectrum{0.5f}});
    for (const PlacedArrivals& arrivals : {PlacedArrivals{}, arrivals_of(nothing)}) {
        const PathGuide guide(arrivals, v);
        const auto d = guide.sample(v, {0.2f, {0.3f, 0.6f}}),
                   plain = sample(v.bsdf, v.w_out, {0.2f, {0.3f, 0.6f}});
        ASSERT_TRUE(d && plain);
        EXPECT_EQ(d->w_in.v.x, plain->w_in.v.x);
        EXPECT_EQ(guide.pdf(v.point.frame.to_world(d->w_in), 0.25f), 0.25f);
        EXPECT_EQ(guide.light_share(), 1);
    }
}

}  // namespace
}  // namespace relumine
