// SPDX-License-Identifier: Apache-2.0
// The kernels against their scalar definitions, on every instruction set that this machine has; built a
// second time with one lane alone (tests/CMakeLists.txt).
#include "blocks/map_kernel.hpp"

#include <gtest/gtest.h>

#include "blocks/test_maps.hpp"
#include "tests/targets.hpp"

namespace relumine {
namespace {

using testing::on_every_target;
using testing::random_direction;
using testing::random_map;
using testing::uniform;

struct Case {
    DirectionGrid grid;
    std::vector<BlockMap> maps;
    Blend blend;

    Case(int side, std::size_t count, bool with_indirect) : grid(side) {
        for (std::uint64_t i = 0; i < count; ++i)
            maps.push_back(random_map(grid, 100 * i + 7, with_indirect));
        for (std::uint64_t i = 0; i < count; ++i) blend.add(maps[i], uniform(i, 1, 0.1f, 1));
        blend.normalize();
    }
    [[nodiscard]] bool knows(const BlockMap& map, std::size_t texel) const {
        return (map.known[texel / tile_texels] >> texel % tile_texels & 1) != 0;
    }
};

std::vector<Case> cases() {
    std::vector<Case> all;
    all.emplace_back(16, 1, true);
    all.emplace_back(16, 3, false);
    all.emplace_back(32, 8, true);
    return all;
}

using Planes = std::array<std::vector<float>, 3>;

Planes random_bsdf(std::size_t count) {
    Planes planes;
    for (std::size_t c = 0; c < 3; ++c)
        for (std::uint64_t i = 0; i < count; ++i) planes[c].push_back(uniform(i, 20 + c));
    return planes;
}
BsdfPlanes pointers(Planes& planes) { return {{planes[0].data(), planes[1].data(), planes[2].data()}}; }
Spectrum at(const Planes& planes, std::size_t i) { return {planes[0][i], planes[1][i], planes[2][i]}; }

void expect_near(Spectrum found, Spectrum expected) {
    EXPECT_NEAR(found.r, expected.r, 2e-5f * expected.r);
    EXPECT_NEAR(found.g, expected.g, 2e-5f * expected.g);
    EXPECT_NEAR(found.b, expected.b, 2e-5f * expected.b);
}
void expect_near(const ReflectedSums& found, const ReflectedSums& expected) {
    expect_near(found.direct, expected.direct);
    expect_near(found.indirect, expected.indirect);
    expect_near(found.albedo, expected.albedo);
}

TEST(MapKernel, BlendsTilesOnEveryTarget) {
    for (const Case& c : cases())
        on_every_target([&] {
            std::vector<float> luminance(c.grid.tiles), variance(c.grid.tiles);
            std::vector<std::uint16_t> known(c.grid.tiles);
            blend_tiles(c.blend, {luminance, variance, known});
            for (std::size_t tile = 0; tile < c.grid.tiles; ++tile) {
                double mean = 0, squares = 0;
                std::uint16_t all = whole_tile;
                for (const auto& [map, weight] : c.blend.maps()) {
                    const double l = map->tile_luminance[tile];
                    mean += weight * l;
                    squares += weight * (l * l + map->tile_variance[tile]);
                    all &= map->known[tile];
                }
                ASSERT_NEAR(luminance[tile], mean, 1e-5 * mean);
                ASSERT_NEAR(variance[tile], squares - mean * mean, 1e-5 * squares);
                ASSERT_EQ(known[tile], all);
            }
        });
}

struct LobeErrors {
    float curvature, slope;
};

/// The same of a lobe with two roughnesses: the curvature along the axis where it is larger.
LobeErrors stretched_errors(Vec3 d, const TierQuery& q, float side2) {
    const Vec3 half = d + q.w_out;
    const float z2 = std::max(sqr(dot(half, q.shading_normal)), 1e-12f);
    const float x2 = sqr(dot(half, q.axis_x) / q.alpha_x) / z2,
                y2 = sqr(dot(half, q.axis_y) / q.alpha_y) / z2;
    const float most =
        std::max((20 * x2 + 4 * y2 + 4) / sqr(q.alpha_x), (20 * y2 + 4 * x2 + 4) / sqr(q.alpha_y));
    const float axes = 0.5f + 2 / length_squared(half), spread = 1 + x2 + y2;
    const float gradient = 4 * std::sqrt(x2 / sqr(q.alpha_x) + y2 / sqr(q.alpha_y)) / spread;
    return {axes * most / sqr(spread) * side2 / 24, gradient * std::sqrt(axes * side2 / 12)};
}

/// The kernel's errors of one point per tile, in other words.
LobeErrors lobe_errors(Vec3 d, const TierQuery& q, float side2) {
    const Vec3 half = normalize(d + q.w_out);
    const float cosine = std::max(std::abs(dot(half, q.shading_normal)), 1e-6f);
    const float t2 = (1 / sqr(cosine) - 1) / sqr(q.alpha);
    // The half vector's motion squared, mean of both axes, against half the direction's.
    const float axes = 0.5f + 2 / length_squared(d + q.w_out);
    return {axes * (20 * t2 + 4) / sqr(1 + t2) * side2 / (24 * sqr(q.alpha)),
            4 * std::sqrt(t2) / (q.alpha * (1 + t2)) * std::sqrt(axes * side2 / 12)};
}

/// The tier, or empty where rounding may decide.
std::optional<TileTier> tier_of(const DirectionGrid& grid, const TierQuery& q, const TileContent& content,
                                std::size_t tile) {
    const Vec3 d = grid.tile_center(tile).v;
    const float above = std::min(dot(d, q.geometric_normal), dot(d, q.shading_normal)),
                sine = grid.tile_sine[tile];
    if (std::abs(std::abs(above) - sine) < 1e-5f) return std::nullopt;
    if (above < -sine) return TileTier::below;
    TileTier tier =
        q.exact || above < sine || content.known[tile] != whole_tile ? TileTier::texels : TileTier::one;
    if (q.alpha <= 0) return tier;
    const float side2 = grid.texel_solid_angle * 4;
    const LobeErrors lobe = q.alpha_x == q.alpha_y ? lobe_errors(d, q, side2) : stretched_errors(d, q, side2);
    const float share = content.lobe_share[tile];
    const float covariance =
        share * lobe.slope * std::sqrt(content.variance[tile]) / content.luminance[tile] / 0.01f;
    const float error = share * lobe.curvature / 0.004f;
    const std::array<std::tuple<float, float, TileTier>, 4> steps{{{covariance, 1, TileTier::texels},
                                                                   {error, 1, TileTier::texels},
                                                                   {error, 16, TileTier::quarters},
                                                                   {error, 64, TileTier::sixteenths}}};
    for (const auto& [found, step, finer] : steps) {
        if (std::abs(found - step) < 1e-3f * step) return std::nullopt;
        if (found > step) tier = finer;
    }
    return tier;
}

TEST(MapKernel, ChoosesTiersOnEveryTarget) {
    const Case c(64, 1, false);
    std::vector<float> lobe_share, luminance, variance;
    for (std::size_t tile = 0; tile < c.grid.tiles; ++tile) {
        lobe_share.push_back(tile % 4 == 0 ? 1 : uniform(tile, 31));
        luminance.push_back(uniform(tile, 32, 0.5f, 2));
        variance.push_back(tile % 3 == 0 ? 0 : sqr(uniform(tile, 33)));
    }
    const TileContent content{lobe_share, luminance, variance, c.maps[0].known};
    for (std::uint64_t pose = 0; pose < 12; ++pose) {
        const Vec3 normal = random_direction(pose, 1).v;
        const Vec3 shading = normalize(normal + random_direction(pose, 3).v * 0.3f);
        const std::array<float, 4> alphas{0, 0.05f, 0.2f, 0.7f};
        TierQuery query{normal,
                        shading,
                        normalize(shading + random_direction(pose, 5).v * 0.9f),
                        alphas[pose % 4],
                        pose % 3 == 0,
                        0,
                        0,
                        {},
                        {}};
        if (pose >= 8) {
            const Frame frame = frame_around(shading);
            query.alpha_x = query.alpha * 2;
            query.alpha_y = query.alpha / 2;
            query.axis_x = frame.s;
            query.axis_y = frame.t;
        }
        on_every_target([&] {
            std::vector<TileTier> tiers(c.grid.tiles);
            choose_tiers(c.grid, query, content, tiers);
            std::size_t open = 0;
            std::array<int, 5> met{};
            for (std::size_t tile = 0; tile < c.grid.tiles; ++tile) {
                const auto expected = tier_of(c.grid, query, content, tile);
                open += !expected;
                if (expected) {
                    ASSERT_EQ(static_cast<int>(tiers[tile]), static_cast<int>(*expected)) << tile;
                }
                ++met[static_cast<std::size_t>(tiers[tile])];
            }
            EXPECT_LT(open, 6u);
            EXPECT_GT(met[0], 80);
            if (query.exact) {
                EXPECT_EQ(met[1], 0);
            }
            if (query.alpha == 0.05f && query.alpha_x == query.alpha_y) {
                EXPECT_GT(met[4], 0);
            }
        });
    }
}

TEST(MapKernel, SumsTilesOnEveryTarget) {
    for (const Case& c : cases()) {
        std::vector<TileTier> tiers;
        for (std::uint64_t tile = 0; tile < c.grid.tiles; ++tile)
            tiers.push_back(static_cast<TileTier>(hash(tile, 9) % 3));
        const Planes bsdf = random_bsdf(c.grid.tiles);
        const Vec3 normal = random_direction(3, 4).v;
        ReflectedSums expected;
        for (std::size_t tile = 0; tile < c.grid.tiles; ++tile) {
            const float cosine = dot(c.grid.tile_center(tile).v, normal) * c.grid.tile_length[tile];
            if (cosine < 0.1f) tiers[tile] = TileTier::below;
            if (tiers[tile] != TileTier::one) continue;
            const Spectrum f = at(bsdf, tile) / cosine;
            const auto received = [&](const RadiancePlanes& planes) {
                const auto channel = [&](std::size_t k) {
                    const auto& m = planes.tile_moments[k];
                    return dot(Vec3{m[0][tile], m[1][tile], m[2][tile]}, normal);
                };
                return Spectrum{channel(0), channel(1), channel(2)};
            };
            for (const auto& [map, weight] : c.blend.maps()) {
                expected.direct += f * received(map->direct) * weight;
                if (!map->indirect.empty()) expected.indirect += f * received(map->indirect) * weight;
            }
            expected.albedo += at(bsdf, tile);
        }
        on_every_target([&] {
            Planes planes = bsdf;
            expect_near(sum_tiles(c.grid, normal, c.blend, tiers, pointers(planes)), expected);
            for (std::size_t tile = 0; tile < c.grid.tiles; ++tile)
                ASSERT_EQ(at(planes, tile), tiers[tile] == TileTier::one ? at(bsdf, tile) : Spectrum{});
        });
    }
}

TEST(MapKernel, SumsTexelsOnEveryTarget) {
    int unknown = 0;
    for (const Case& c : cases()) {
        std::vector<std::uint32_t> tiles;
        for (std::uint32_t tile = 0; tile < c.grid.tiles; ++tile)
            if (tile % 5 != 2) tiles.push_back(tile);
        Planes bsdf = random_bsdf(tiles.size() * tile_texels);
        ReflectedSums expected;
        std::vector<TexelSums> expected_by_tile(tiles.size());
        for (std::size_t i = 0; i < tiles.size() * tile_texels; ++i) {
            const std::size_t texel = tiles[i / tile_texels] * tile_texels + i % tile_texels;
            Spectrum direct, indirect;
            float known = 0;
            for (const auto& [map, weight] : c.blend.maps()) {
                if (!c.knows(*map, texel)) continue;
                known += weight;
                direct += map->direct.at(texel) * weight;
                if (!map->indirect.empty()) indirect += map->indirect.at(texel) * weight;
            }
            if (known > 0) {
                expected.direct += at(bsdf, i) * direct / known;
                expected.indirect += at(bsdf, i) * indirect / known;
            }
            expected.albedo += at(bsdf, i);
            expected_by_tile[i / tile_texels].bsdf += luminance(at(bsdf, i));
            expected_by_tile[i / tile_texels].unknown += known > 0 ? 0.0f : 1.0f;
            unknown += known <= 0;
        }
        on_every_target([&] {
            std::vector<TexelSums> by_tile(tiles.size());
            expect_near(sum_texels(c.blend, tiles, pointers(bsdf), by_tile), expected);
            for (std::size_t k = 0; k < tiles.size(); ++k) {
                ASSERT_NEAR(by_tile[k].bsdf, expected_by_tile[k].bsdf, 1e-5f * expected_by_tile[k].bsdf);
                ASSERT_EQ(by_tile[k].unknown, expected_by_tile[k].unknown);
            }
        });
    }
    EXPECT_GT(unknown, 0);
}

TEST(MapKernel, SumsOpenTexelsOnEveryTarget) {
    for (const Case& c : cases()) {
        std::vector<std::uint32_t> tiles;
        for (std::uint32_t tile = 1; tile < c.grid.tiles; tile += 3) tiles.push_back(tile);
        Planes detail = random_bsdf(tiles.size() * tile_texels);
        Spectrum expected;
        for (std::size_t i = 0; i < tiles.size() * tile_texels; ++i) {
            const std::size_t tile = tiles[i / tile_texels], bit = i % tile_texels;
            float open = 0, known = 0;
            for (const auto& [map, weight] : c.blend.maps()) {
                open += (map->open[tile] >> bit & 1) ? weight : 0;
                known += (map->known[tile] >> bit & 1) ? weight : 0;
            }
            if (known > 0) expected += at(detail, i) * (open / known);
        }
        on_every_target([&] { expect_near(sum_open(c.blend, tiles, pointers(detail)), expected); });
    }
}

TEST(MapKernel, SumsOverNoTilesAreNothing) {
    const Case c(16, 2, true);
    Planes none;
    on_every_target([&] {
        EXPECT_EQ(sum_texels(c.blend, {}, pointers(none), {}).albedo, Spectrum{});
        EXPECT_EQ(sum_open(c.blend, {}, pointers(none)), Spectrum{});
    });
}

}  // namespace
}  // namespace relumine
