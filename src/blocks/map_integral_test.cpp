// SPDX-License-Identifier: Apache-2.0
// Integrals over maps: furnaces, closed forms, and the piecewise constant integrand behind them.
#include "blocks/map_integral.hpp"

#include <gtest/gtest.h>

#include "blocks/test_maps.hpp"
#include "tests/bsdfs.hpp"

namespace relumine {
namespace {

using testing::MapStage;
using testing::open_map;
using testing::random_map;

constexpr Frame world{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};

Vertex vertex_of(const Bsdf& bsdf, float view_cosine, Vec3 normal = normalize({0.2f, -0.3f, 0.9f})) {
    Vertex vertex{
        {},
        {{std::sqrt(1 - sqr(view_cosine)) * 0.8f, std::sqrt(1 - sqr(view_cosine)) * 0.6f, view_cosine}},
        bsdf};
    vertex.point.frame = frame_around(normal);
    vertex.point.geometric_normal = normal;
    return vertex;
}

/// The BSDF times the environment's radiance, or 1, integrated by sampling the BSDF on a grid of 512².
Spectrum by_sampling(const Vertex& vertex, const LightSampler* lights) {
    constexpr int side = 512;
    double r = 0, g = 0, b = 0;
    for (int i = 0; i < side * side; ++i) {
        const Point2 u{(static_cast<float>(i % side) + 0.5f) / side,
                       (static_cast<float>(i / side) + 0.5f) / side};
        const auto s = sample(vertex.bsdf, vertex.w_out, {0, u});
        if (!s) continue;
        Spectrum value = s->weight;
        if (lights) value = value * lights->environment_radiance(vertex.point.frame.to_world(s->w_in));
        r += value.r;
        g += value.g;
        b += value.b;
    }
    constexpr double n = side * side;
    return {static_cast<float>(r / n), static_cast<float>(g / n), static_cast<float>(b / n)};
}

Blend blend_of(const std::vector<BlockMap>& maps) {
    Blend blend;
    for (std::size_t i = 0; i < maps.size(); ++i) blend.add(maps[i], static_cast<float>(i + 1));
    blend.normalize();
    return blend;
}

MapIntegral integral_of(const MapStage& stage, const QuadraturePoints& points, bool exact, const Blend& blend,
                        const Vertex& vertex) {
    MapIntegral integral(stage.grid(), points, stage.environment(), exact);
    integral.run(blend, *receiver_bsdf(vertex, world), vertex.point.geometric_normal);
    return integral;
}

Bsdf metal(float alpha) { return RoughConductor{{0.9f, 0.7f, 0.5f}, {alpha, Masking::correlated}}; }
Bsdf brushed(float alpha_x, float alpha_y) {
    return RoughConductor{{0.9f, 0.7f, 0.5f}, make_ggx(alpha_x, alpha_y, Masking::correlated)};
}
Bsdf plastic() {
    return MetallicRoughness{{0.5f, 0.2f, 0.1f},
                             Spectrum{0.04f},
                             Spectrum{1},
                             Spectrum{0.04f},
                             Spectrum{1},
                             {0.2f, Masking::correlated},
                             false};
}

/// Under each kind of layer: a clear coat sharper than the base's lobe, sheen, both, pbrt's coat.
std::vector<Bsdf> layered_surfaces() {
    const MetallicRoughness base = testing::plastic({0.5f, 0.2f, 0.1f}, 0.5f);
    MetallicRoughness brushed = base;
    brushed.ggx = make_ggx(0.6f, 0.2f, Masking::correlated);
    return {testing::coated(base, 1, 0.1f), testing::coated(brushed, 1, 0.3f),
            testing::with_sheen(testing::coated(base, 0, 1), {0.8f, 0.6f, 0.3f}, 0.2f),
            testing::with_sheen(testing::coated(base, 0.5f, 0.2f), {0.8f, 0.6f, 0.3f}, 0.5f),
            CoatedDiffuse{{0.7f, 0.4f, 0.2f}, 1.5f, {0.2f, Masking::correlated}}};
}

class MapIntegrals : public ::testing::Test {
  protected:
    const MapStage stage{{}, testing::even_sky(Spectrum{1}), 64};
    const QuadraturePoints points{stage.grid()};
    const std::vector<BlockMap> white{open_map(stage.grid(), [](std::size_t) { return Spectrum{1}; })};
};

void expect_linear(const MapStage& stage, const QuadraturePoints& points, const Vertex& vertex) {
    const BlockMap map = random_map(stage.grid(), 7);
    const auto reflected = [&](const ReceiverBsdf& bsdf) {
        MapIntegral integral(stage.grid(), points, stage.environment(), false);
        integral.run(blend_of({map}), bsdf, vertex.point.geometric_normal);
        return integral.reflected().indirect;
    };
    ReceiverBsdf brown = *receiver_bsdf(vertex, world), green = brown, matte = without_lobes(brown);
    const Spectrum ratio{0.4f, 3, 2};
    green.diffuse = brown.diffuse * ratio;
    const Spectrum part = reflected(matte), expected = reflected(brown) + part * (ratio - Spectrum{1});
    const Spectrum found = reflected(green);
    EXPECT_NEAR(found.r, expected.r, 0.004f * found.r);
    EXPECT_NEAR(found.g, expected.g, 0.004f * found.g);
    EXPECT_NEAR(found.b, expected.b, 0.004f * found.b);
    EXPECT_GT(part.g, 0.1f * found.g);
}

/// What lets samples of different colour share an integral: the diffuse part alone is another one.
TEST_F(MapIntegrals, OfALayeredSurfaceAreLinearInItsDiffuseColour) {
    std::vector<Bsdf> surfaces = layered_surfaces();
    surfaces.push_back(plastic());
    for (const Bsdf& surface : surfaces) expect_linear(stage, points, vertex_of(surface, 0.7f));
}

TEST_F(MapIntegrals, ReflectTheAlbedoInAWhiteFurnace) {
    for (const bool exact : {false, true})
        for (const Bsdf& bsdf : {Bsdf{Lambert{{0.8f, 0.5f, 0.2f}}}, metal(0.07f), metal(0.5f),
                                 brushed(0.4f, 0.05f), plastic()}) {
            const MapIntegral integral =
                integral_of(stage, points, exact, blend_of(white), vertex_of(bsdf, 0.7f));
            const Spectrum reflected = integral.reflected().direct, albedo = integral.albedo();
            EXPECT_NEAR(reflected.r, albedo.r, 1e-5f);
            EXPECT_NEAR(reflected.g, albedo.g, 1e-5f);
            EXPECT_NEAR(reflected.b, albedo.b, 1e-5f);
            EXPECT_TRUE(is_black(integral.reflected().indirect));
        }
}

/// Σ over texels of radiance times f·|cos θ| at 16 points of each.
Spectrum texel_by_texel(const DirectionGrid& grid, const BlockMap& map, const ReceiverBsdf& bsdf,
                        Vec3 normal) {
    constexpr int side = 4, points = side * side;
    std::array<std::vector<float>, 3> d, f;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        d[axis].resize(grid.texels * points);
        f[axis].resize(grid.texels * points);
    }
    for (std::uint32_t texel = 0; texel < grid.texels; ++texel)
        for (int i = 0; i < points; ++i) {
            const Vec3 w = grid.direction_in(texel, {(static_cast<float>(i % side) + 0.5f) / side,
                                                     (static_cast<float>(i / side) + 0.5f) / side})
                               .v;
            const std::size_t at = texel * points + static_cast<std::size_t>(i);
            d[0][at] = w.x;
            d[1][at] = w.y;
            d[2][at] = w.z;
        }
    evaluate(bsdf, {d[0], d[1], d[2]}, {f[0], f[1], f[2]});
    Spectrum sum;
    for (std::size_t at = 0; at < f[0].size(); ++at)
        if (dot(Vec3{d[0][at], d[1][at], d[2][at]}, normal) > 0)
            sum += Spectrum{f[0][at], f[1][at], f[2][at]} * map.direct.at(at / points);
    return sum * (grid.texel_solid_angle / points);
}

/// One point per tile is not enough where light falls off together with the cosine, or with a lobe.
TEST_F(MapIntegrals, FollowLightThatVariesWithinTiles) {
    std::vector<Bsdf> surfaces = layered_surfaces();
    for (const Bsdf& bsdf : {Bsdf{Lambert{{0.8f, 0.5f, 0.2f}}}, metal(0.6f), plastic()})
        surfaces.push_back(bsdf);
    for (const Bsdf& bsdf : surfaces)
        for (const Vec3 from : {Vec3{1, 0, 0.1f}, Vec3{0, -1, 0.3f}, Vec3{-0.6f, 0.5f, -0.2f}}) {
            const BlockMap map = open_map(stage.grid(), [&](std::size_t texel) {
                return Spectrum{std::exp(5 * dot(normalize(from), stage.grid().texel_center(texel).v))};
            });
            const Vertex vertex = vertex_of(bsdf, 0.7f);
            MapIntegral integral(stage.grid(), points, stage.environment(), false);
            // The sky is white: as if nothing of it were open.
            BlockMap seen = map;
            seen.open.assign(seen.open.size(), 0);
            const ReceiverBsdf receiver = *receiver_bsdf(vertex, world);
            integral.run(blend_of({seen}), receiver, vertex.point.geometric_normal);
            const Spectrum expected =
                texel_by_texel(stage.grid(), map, receiver, vertex.point.geometric_normal);
            const Spectrum found = integral.reflected().direct;
            // What refracts lets little in from the horizon, where one point stands for a tile.
            const float tolerance = receiver.over.eta > 0 ? 0.007f : 0.004f;
            EXPECT_NEAR(found.r, expected.r, tolerance * expected.r);
            EXPECT_NEAR(found.g, expected.g, tolerance * expected.g);
            EXPECT_NEAR(found.b, expected.b, tolerance * expected.b);
        }
}

TEST_F(MapIntegrals, HaveTheAlbedoOfMatteSurfaces) {
    for (const Vec3 normal : {Vec3{0, 0, 1}, Vec3{1, 0, 0}, Vec3{0, -1, 0}, normalize({1, 1, -1})}) {
        const Vertex vertex = vertex_of(Lambert{{0.8f, 0.5f, 0.2f}}, 0.5f, normal);
        const Spectrum albedo = integral_of(stage, points, false, blend_of(white), vertex).albedo();
        EXPECT_NEAR(albedo.r, 0.8f, 0.8f * 0.001f);
        EXPECT_NEAR(albedo.b, 0.2f, 0.2f * 0.001f);
    }
}

TEST_F(MapIntegrals, HaveTheAlbedoOfGlossySurfaces) {  // against sampling the BSDF
    for (const float alpha : {0.5f, 0.2f, 0.07f})
        for (const float view : {0.95f, 0.6f, 0.3f}) {
            const Vertex vertex = vertex_of(metal(alpha), view);
            const Spectrum albedo = integral_of(stage, points, false, blend_of(white), vertex).albedo(),
                           expected = by_sampling(vertex, nullptr);
            EXPECT_NEAR(albedo.r, expected.r, 0.005f * expected.r) << alpha << " " << view;
            EXPECT_NEAR(albedo.b, expected.b, 0.005f * expected.b) << alpha << " " << view;
        }
}

TEST_F(MapIntegrals, HaveTheAlbedoOfBrushedSurfaces) {
    for (const auto& [x, y] : {std::pair{0.5f, 0.1f}, {0.05f, 0.3f}})
        for (const float view : {0.95f, 0.6f, 0.3f}) {
            const Vertex vertex = vertex_of(brushed(x, y), view);
            const Spectrum albedo = integral_of(stage, points, false, blend_of(white), vertex).albedo(),
                           expected = by_sampling(vertex, nullptr);
            EXPECT_NEAR(albedo.r, expected.r, 0.007f * expected.r) << x << " " << y << " " << view;
            EXPECT_NEAR(albedo.b, expected.b, 0.007f * expected.b) << x << " " << y << " " << view;
        }
}

/// Of f over the whole sphere, by the midpoint rule over cos θ and φ.
Spectrum by_midpoints(const Vertex& vertex) {
    constexpr int side = 400;
    double r = 0, g = 0, b = 0;
    for (int i = 0; i < side; ++i)
        for (int j = 0; j < side; ++j) {
            const float cosine = (static_cast<float>(i) + 0.5f) / side,
                        phi = 2 * pi * (static_cast<float>(j) + 0.5f) / side;
            const Spectrum f = eval(vertex.bsdf, vertex.w_out, testing::direction(cosine, phi));
            r += f.r;
            g += f.g;
            b += f.b;
        }
    constexpr double cell = 2 * 3.14159265358979 / (side * side);
    return {static_cast<float>(r * cell), static_cast<float>(g * cell), static_cast<float>(b * cell)};
}

TEST_F(MapIntegrals, HaveTheAlbedoOfLayeredSurfaces) {
    const std::vector<Bsdf> surfaces = layered_surfaces();
    for (const Bsdf& bsdf : surfaces)
        for (const float view : {0.95f, 0.6f, 0.3f}) {
            const Vertex vertex = vertex_of(bsdf, view);
            const Spectrum albedo = integral_of(stage, points, false, blend_of(white), vertex).albedo(),
                           expected = by_midpoints(vertex);
            EXPECT_NEAR(albedo.r, expected.r, 0.004f * expected.r) << &bsdf - surfaces.data() << " " << view;
            EXPECT_NEAR(albedo.b, expected.b, 0.004f * expected.b) << &bsdf - surfaces.data() << " " << view;
        }
}

/// Σ f·L·dω over all texels.
MapRadiance sum_over_texels(const MapIntegral& integral) {
    std::array<double, 6> sums{};
    for (std::uint32_t texel = 0; texel < integral.grid().texels; ++texel) {
        const Spectrum f = integral.bsdf_at(texel) * integral.grid().texel_solid_angle;
        const MapRadiance l = integral.radiance_at(texel);
        for (int c = 0; c < 3; ++c) {
            const auto channel = [&](Spectrum s) { return double{c == 0 ? s.r : c == 1 ? s.g : s.b}; };
            sums[static_cast<std::size_t>(c)] += channel(f * l.direct);
            sums[static_cast<std::size_t>(3 + c)] += channel(f * l.indirect);
        }
    }
    const auto real = [&](std::size_t i) { return static_cast<float>(sums[i]); };
    return {{real(0), real(1), real(2)}, {real(3), real(4), real(5)}};
}

TEST_F(MapIntegrals, AreTheSumOfTheirIntegrandWhereExact) {
    const std::vector<BlockMap> maps{random_map(stage.grid(), 3), random_map(stage.grid(), 300),
                                     random_map(stage.grid(), 900)};
    for (const Bsdf& bsdf : {Bsdf{Lambert{{0.8f, 0.5f, 0.2f}}}, metal(0.07f), metal(0.5f), plastic()})
        for (const float view : {0.9f, 0.2f}) {
            const MapIntegral integral =
                integral_of(stage, points, true, blend_of(maps), vertex_of(bsdf, view));
            const MapRadiance expected = sum_over_texels(integral), found = integral.reflected();
            EXPECT_NEAR(found.direct.r, expected.direct.r, 1e-4f * expected.direct.r);
            EXPECT_NEAR(found.direct.b, expected.direct.b, 1e-4f * expected.direct.b);
            EXPECT_NEAR(found.indirect.r, expected.indirect.r, 1e-4f * expected.indirect.r);
            EXPECT_NEAR(found.indirect.g, expected.indirect.g, 1e-4f * expected.indirect.g);
            EXPECT_GT(expected.indirect.g, 0.05f);
        }
}

/// A shading normal that leans over the horizon: what is below the surface does not count.
TEST_F(MapIntegrals, LeaveOutWhatIsBelowTheSurface) {
    Vertex vertex = vertex_of(Lambert{Spectrum{1}}, 0.8f, {0, 0, 1});
    vertex.point.geometric_normal = normalize({0.8f, 0, 0.6f});
    const Spectrum albedo = integral_of(stage, points, false, blend_of(white), vertex).albedo();
    const float expected = (1 + 0.6f) / 2;  // the projected disc's visible part: (1 + cos θ) / 2
    EXPECT_NEAR(albedo.r, expected, 0.005f);
}

TEST_F(MapIntegrals, EstimateNoDeviationWhereNothingIsReflected) {
    MapIntegral integral =
        integral_of(stage, points, false, blend_of(white), vertex_of(Lambert{Spectrum{0.5f}}, 0.8f));
    integral.estimate_deviations();
    for (std::size_t tile = 0; tile < stage.grid().tiles; ++tile) {
        const float height = dot(stage.grid().tile_center(tile).v, normalize({0.2f, -0.3f, 0.9f}));
        if (height < -stage.grid().tile_sine[tile]) {
            EXPECT_EQ(integral.deviations()[tile], 0);
        }
        if (height > stage.grid().tile_sine[tile]) {
            EXPECT_GT(integral.deviations()[tile], 0);
        }
    }
}

Environment striped_sky() {
    Environment e{256, 128, {}, 0.3f};
    for (int y = 0; y < 128; ++y)
        for (int x = 0; x < 256; ++x) {
            const float wave =
                std::sin(static_cast<float>(x) * 0.5f) * std::cos(static_cast<float>(y) * 0.4f);
            e.radiance.push_back(Spectrum{1 + 0.9f * wave, 1 - 0.9f * wave, 0.5f});
        }
    return e;
}

/// Waves of 18° under lobes as wide: texels' means would blur them.
TEST(MapIntegralDetail, ResolvesTheEnvironmentInSharpLobes) {
    const MapStage stage({}, striped_sky(), 64);
    const QuadraturePoints points(stage.grid());
    const std::vector<BlockMap> maps{
        open_map(stage.grid(), [&](std::size_t texel) { return stage.environment().texels[texel]; })};
    float blurred = 0;
    for (const float alpha : {0.15f, 0.07f, 0.03f})
        for (const float view : {0.95f, 0.8f, 0.6f}) {
            const Vertex vertex = vertex_of(metal(alpha), view);
            const Spectrum expected = by_sampling(vertex, &stage.transport().lights);
            const Spectrum found =
                integral_of(stage, points, false, blend_of(maps), vertex).reflected().direct;
            EXPECT_NEAR(found.r, expected.r, 0.005f * expected.r) << alpha << " " << view;
            EXPECT_NEAR(found.g, expected.g, 0.005f * expected.g) << alpha << " " << view;
            EXPECT_NEAR(found.b, expected.b, 0.005f * expected.b) << alpha << " " << view;
            const Spectrum means =
                integral_of(stage, points, true, blend_of(maps), vertex).reflected().direct;
            blurred = std::max(blurred, std::abs(means.r / expected.r - 1));
        }
    EXPECT_GT(blurred, 0.01f);  // without the detail it would not do
}

}  // namespace
}  // namespace relumine
