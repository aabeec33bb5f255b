// SPDX-License-Identifier: Apache-2.0
// The BSDF kernel against the BSDFs, on every instruction set that this machine has and with one lane alone.
#include "cache/receiver_bsdf.hpp"

#include <gtest/gtest.h>

#include "cache/test_random.hpp"
#include "tests/bsdfs.hpp"
#include "tests/targets.hpp"

namespace relumine {
namespace {

using testing::on_every_target;
using testing::random_direction;
using testing::uniform;

Vertex vertex_of(const Bsdf& bsdf, LocalDir w_out) {
    Vertex vertex{{}, w_out, bsdf};
    vertex.point.frame = frame_around(normalize({0.1f, 0.3f, 1}));
    return vertex;
}

/// Every layer alone and above every other, rough, sharp and too smooth for a lobe.
std::vector<Bsdf> layered_bsdfs() {
    const MetallicRoughness plastic = testing::plastic({0.5f, 0.2f, 0.1f}, 0.4f),
                            brushed{{}, {}, {}, {0.9f, 0.6f, 0.3f}, Spectrum{1}, testing::ggx(0.3f, 0.08f)};
    MetallicRoughness smooth = plastic, brushed_plastic = plastic;
    smooth.smooth = true;
    brushed_plastic.ggx = testing::ggx(0.1f, 0.6f);
    std::vector<Bsdf> all;
    for (const MetallicRoughness& base : {plastic, brushed, smooth, brushed_plastic}) {
        for (const float alpha : {0.6f, 0.03f}) all.emplace_back(testing::coated(base, 0.8f, alpha));
        CoatedLayers smooth_coat = testing::coated(base, 1, smooth_alpha);
        smooth_coat.clearcoat_smooth = true;
        all.emplace_back(without_delta(smooth_coat));
        for (const float alpha : {1.0f, 0.25f, 0.01f}) {
            all.emplace_back(testing::with_sheen(testing::coated(base, 0, 0.5f), {0.9f, 0.5f, 0.1f}, alpha));
            all.emplace_back(testing::with_sheen(testing::coated(base, 1, 0.2f), {0.1f, 0.4f, 0.8f}, alpha));
        }
    }
    CoatedLayers separable = testing::coated(plastic, 1, 0.3f);
    separable.clearcoat_ggx.masking = Masking::separable;
    all.emplace_back(separable);
    for (const float eta : {1.5f, 2.2f, 1 / 1.5f})
        for (const Ggx& ggx : {testing::ggx(0.3f), testing::ggx(0.05f), testing::ggx(0.5f, 0.1f)})
            for (const bool without : {false, true}) {
                CoatedDiffuse coated{{0.7f, 0.4f, 0.2f}, eta, ggx};
                coated.smooth = without;
                all.push_back(without_delta(coated));
            }
    return all;
}

TEST(ReceiverBsdfKernel, AgreesWithTheBsdfsOnEveryTarget) {
    const Ggx sharp{0.05f, Masking::correlated}, rough{0.6f, Masking::separable};
    MetallicRoughness plastic{{0.5f, 0.2f, 0.1f}, Spectrum{0.04f}, Spectrum{1}, Spectrum{0.04f},
                              Spectrum{1},        rough,           false};
    MetallicRoughness coat_alone = plastic;
    coat_alone.smooth = true;
    MetallicRoughness stretched = plastic;
    stretched.ggx = make_ggx(0.7f, 0.05f, Masking::correlated);
    std::vector<Bsdf> bsdfs{Lambert{{0.7f, 0.5f, 0.2f}},
                            RoughConductor{{0.9f, 0.6f, 0.3f}, sharp},
                            RoughConductor{{0.9f, 0.6f, 0.3f}, rough},
                            plastic,
                            without_delta(coat_alone),
                            RoughConductor{{0.9f, 0.6f, 0.3f}, make_ggx(0.1f, 0.5f, Masking::separable)},
                            stretched};
    std::ranges::copy(layered_bsdfs(), std::back_inserter(bsdfs));
    constexpr std::size_t count = 1003;  // no multiple of any number of lanes
    const Frame receiver = frame_around({0, 0, 1});
    on_every_target([&] {
        for (const Bsdf& bsdf : bsdfs)
            for (std::uint64_t view = 0; view < 5; ++view) {
                const Vertex vertex =
                    vertex_of(bsdf, {normalize(Vec3{0, 0, 0.1f}
                                               + Vec3{uniform(view, 1, -1, 1), uniform(view, 2, -1, 1),
                                                      uniform(view, 3, 0, 1)})});
                const auto b = receiver_bsdf(vertex, receiver);
                ASSERT_TRUE(b.has_value());
                std::vector<float> x(count), y(count), z(count), red(count), green(count), blue(count);
                for (std::size_t i = 0; i < count; ++i) {
                    const Vec3 w = random_direction(i, 50);
                    x[i] = w.x;
                    y[i] = w.y;
                    z[i] = w.z;
                }
                evaluate(*b, {x, y, z}, {red, green, blue});
                for (std::size_t i = 0; i < count; ++i) {
                    const LocalDir w_in =
                        vertex.point.frame.to_local(receiver.to_world({{x[i], y[i], z[i]}}));
                    const Spectrum expected = eval(bsdf, vertex.w_out, w_in);
                    if (std::abs(w_in.v.z) < 1e-5f) continue;  // rounding decides which side that is
                    // Half vectors of sharp lobes lose digits in either formula.
                    ASSERT_NEAR(red[i], expected.r, 2e-4f * expected.r + 1e-7f)
                        << i << " of " << &bsdf - bsdfs.data();
                    ASSERT_NEAR(green[i], expected.g, 2e-4f * expected.g + 1e-7f) << i;
                    ASSERT_NEAR(blue[i], expected.b, 2e-4f * expected.b + 1e-7f) << i;
                }
            }
    });
    EXPECT_FALSE(
        receiver_bsdf(vertex_of(RoughDielectric{1.5f, Spectrum{1}, false, rough}, {{0, 0, 1}}), receiver)
            .has_value());
}

TEST(ReceiverBsdfKernel, EvaluatesTheCellsThatAreWantedOnEveryTarget) {
    constexpr std::size_t side = mask_side / 2, count = side * side;
    std::vector<float> x(count), y(count), z(count);
    for (std::size_t i = 0; i < count; ++i) {
        const Vec3 w = random_direction(i, 50);
        x[i] = w.x, y[i] = w.y, z[i] = w.z;
    }
    CellMask wanted{};
    wanted[0] = 1, wanted[7] = std::uint64_t{1} << 40, wanted[30] = 0xff00,
    wanted[63] = std::uint64_t{1} << 63;
    const auto bsdf =
        receiver_bsdf(vertex_of(Lambert{{0.7f, 0.5f, 0.2f}}, {{0, 0, 1}}), frame_around({0, 0, 1}));
    on_every_target([&] {
        std::vector<float> r(count), g(count), b(count), red(count, -1), green(count, -1), blue(count, -1);
        evaluate(*bsdf, {x, y, z}, {r, g, b});
        evaluate_cells(*bsdf, {x, y, z}, wanted, {red, green, blue});
        for (std::size_t i = 0; i < count; ++i) {
            if ((wanted[i / side] >> i % side & 1) == 0) continue;
            EXPECT_EQ(red[i], r[i]) << i;
            EXPECT_EQ(green[i], g[i]) << i;
            EXPECT_EQ(blue[i], b[i]) << i;
        }
        EXPECT_EQ(red[20 * side], -1);  // nothing near it is wanted
    });
}

/// Quadrature points in the runs that evaluate_tiles reads, for `tiles` tiles.
DirectionRuns random_runs(std::size_t tiles, std::size_t per_texel) {
    DirectionRuns runs;
    for (std::uint64_t i = 0; i < 16 * tiles * per_texel; ++i) {
        const Vec3 w = random_direction(i, 60);
        runs.x.push_back(w.x);
        runs.y.push_back(w.y);
        runs.z.push_back(w.z);
    }
    return runs;
}

struct TileMeans {
    std::vector<Spectrum> bsdf, product;
};

/// Means of f·|cos θ| and of its product with radiance, point by point; rounding decides at horizons.
TileMeans means_over_tiles(const ReceiverBsdf& bsdf, Vec3 normal, const DirectionRuns& runs,
                           const RadianceRuns& light, std::size_t per_texel,
                           std::span<const std::uint32_t> tiles) {
    TileMeans means;
    for (const std::uint32_t tile : tiles)
        for (std::size_t texel = 0; texel < 16; ++texel) {
            Spectrum sum, product;
            for (std::size_t point = 0; point < per_texel; ++point) {
                const std::size_t i = 16 * (tile * per_texel + point) + texel;
                if (runs.x[i] * normal.x + runs.y[i] * normal.y + runs.z[i] * normal.z <= 0) continue;
                Spectrum f;
                evaluate(bsdf, {{&runs.x[i], 1}, {&runs.y[i], 1}, {&runs.z[i], 1}},
                         {{&f.r, 1}, {&f.g, 1}, {&f.b, 1}});
                sum += f;
                product += f * Spectrum{light.r[i], light.g[i], light.b[i]};
            }
            means.bsdf.push_back(sum / static_cast<float>(per_texel));
            means.product.push_back(product / static_cast<float>(per_texel));
        }
    return means;
}

TEST(ReceiverBsdfKernel, AveragesOverTheTexelsOfTilesOnEveryTarget) {
    const MetallicRoughness plastic{{0.5f, 0.2f, 0.1f},
                                    Spectrum{0.04f},
                                    Spectrum{1},
                                    Spectrum{0.04f},
                                    Spectrum{1},
                                    {0.3f, Masking::correlated},
                                    false};
    const std::array<Bsdf, 4> bsdfs{
        Lambert{{0.7f, 0.5f, 0.2f}}, RoughConductor{{0.9f, 0.6f, 0.3f}, {0.1f, Masking::correlated}}, plastic,
        testing::with_sheen(testing::coated(plastic, 0.7f, 0.1f), {0.5f, 0.3f, 0.1f}, 0.3f)};
    const std::vector<std::uint32_t> tiles{0, 3, 4, 6};
    const Vec3 normal = normalize({0.3f, 0.2f, 1});
    for (const std::size_t per_texel : {std::size_t{1}, std::size_t{4}, std::size_t{16}}) {
        const DirectionRuns runs = random_runs(7, per_texel);
        RadianceRuns light;
        for (std::uint64_t i = 0; i < runs.x.size(); ++i) {
            light.r.push_back(uniform(i, 70, 0, 3));
            light.g.push_back(uniform(i, 71, 0, 2));
            light.b.push_back(uniform(i, 72, 0, 1));
        }
        for (const Bsdf& bsdf : bsdfs) {
            const auto b = receiver_bsdf(vertex_of(bsdf, {normalize({0.3f, 0.4f, 0.8f})}),
                                         {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}});
            ASSERT_TRUE(b.has_value());
            const TileMeans expected = means_over_tiles(*b, normal, runs, light, per_texel, tiles);
            on_every_target([&] {
                std::vector<float> r(64), g(64), x(64), y(64);
                evaluate_tiles(*b, normal, runs, per_texel, tiles, {r, g, x});
                for (std::size_t i = 0; i < r.size(); ++i) {
                    ASSERT_NEAR(r[i], expected.bsdf[i].r, 3e-4f * expected.bsdf[i].r + 1e-7f) << i;
                    ASSERT_NEAR(g[i], expected.bsdf[i].g, 3e-4f * expected.bsdf[i].g + 1e-7f) << i;
                    ASSERT_NEAR(x[i], expected.bsdf[i].b, 3e-4f * expected.bsdf[i].b + 1e-7f) << i;
                }
                evaluate_products(*b, normal, runs, light, per_texel, tiles, {r, g, y});
                for (std::size_t i = 0; i < r.size(); ++i) {
                    ASSERT_NEAR(r[i], expected.product[i].r, 3e-4f * expected.product[i].r + 1e-7f) << i;
                    ASSERT_NEAR(g[i], expected.product[i].g, 3e-4f * expected.product[i].g + 1e-7f) << i;
                    ASSERT_NEAR(y[i], expected.product[i].b, 3e-4f * expected.product[i].b + 1e-7f) << i;
                }
            });
        }
    }
}

/// Without lobes there is the base as seen through all layers, which is what changes with its colour.
TEST(ReceiverBsdfKernel, WithoutLobesIsTheDiffusePart) {
    const Frame receiver = frame_around({0, 0, 1});
    for (const Bsdf& bsdf : layered_bsdfs()) {
        const ReceiverBsdf all = *receiver_bsdf(vertex_of(bsdf, {normalize({0.3f, 0.4f, 0.8f})}), receiver);
        ReceiverBsdf doubled = all;
        doubled.diffuse = all.diffuse * 2;
        EXPECT_TRUE(is_layered(all));
        EXPECT_EQ(has_lobes(all), least_width(all) < infinity);
        for (std::uint64_t i = 0; i < 20; ++i) {
            const Vec3 w = random_direction(i, 50);
            const auto value = [&](const ReceiverBsdf& b) {
                Spectrum f;
                evaluate(b, {{&w.x, 1}, {&w.y, 1}, {&w.z, 1}}, {{&f.r, 1}, {&f.g, 1}, {&f.b, 1}});
                return f;
            };
            const Spectrum whole = value(all), more = value(doubled), part = value(without_lobes(all));
            EXPECT_NEAR(more.r - whole.r, part.r, 1e-5f * more.r + 1e-9f);
            EXPECT_NEAR(more.b - whole.b, part.b, 1e-5f * more.b + 1e-9f);
        }
    }
}

}  // namespace
}  // namespace relumine
