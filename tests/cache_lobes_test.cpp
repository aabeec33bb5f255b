// SPDX-License-Identifier: Apache-2.0
// `cache` on lobes that are sharp: glaze, near mirrors, lamps in gloss, glass that is nearly smooth.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/cache_support.hpp"

namespace relumine {
namespace {

using testing::block_means;
using testing::Estimate;
using testing::welch_p;

/// Of radius 1.
struct Sphere {
    std::vector<std::array<float, 3>> positions;
    std::vector<std::array<std::uint32_t, 3>> triangles;
};
Sphere sphere(std::uint32_t rings) {
    Sphere s;
    const std::uint32_t turns = 2 * rings;
    for (std::uint32_t ring = 0; ring <= rings; ++ring)
        for (std::uint32_t turn = 0; turn < turns; ++turn) {
            const float theta = static_cast<float>(ring) / static_cast<float>(rings) * 3.14159265f,
                        phi = static_cast<float>(turn) / static_cast<float>(turns) * 6.2831853f;
            s.positions.push_back(
                {std::sin(theta) * std::cos(phi), std::cos(theta), -std::sin(theta) * std::sin(phi)});
        }
    for (std::uint32_t ring = 0; ring < rings; ++ring)
        for (std::uint32_t turn = 0; turn < turns; ++turn) {
            const std::uint32_t a = ring * turns + turn, b = ring * turns + (turn + 1) % turns;
            s.triangles.push_back({a, a + turns, b});
            s.triangles.push_back({b, a + turns, b + turns});
        }
    return s;
}

void add_quad(SceneBuilder& builder, const std::array<std::array<float, 3>, 4>& corners,
              const MaterialDescription& material) {
    const std::vector<std::array<std::uint32_t, 3>> triangles{{0, 1, 2}, {0, 2, 3}};
    MeshDescription quad;
    quad.positions = corners;
    quad.triangles = triangles;
    quad.material = builder.add_material(material);
    builder.add_instance(builder.add_mesh(quad));
}

/// A floor, looked down upon at 30°.
SceneBuilder floor_of(const MaterialDescription& material) {
    SceneBuilder builder;
    add_quad(builder, {{{-9, -1, 9}, {9, -1, 9}, {9, -1, -99}, {-9, -1, -99}}}, material);
    CameraDescription camera;
    camera.world_from_camera = {1, 0, 0, 0, 0, 0.866, -0.5, 0, 0, 0.5, 0.866, 0, 0, 0, 0, 1};
    builder.add_camera(camera);
    return builder;
}

/// Brighter above.
Scene under_a_sky(SceneBuilder builder) {
    std::vector<float> sky(24, 1);  // 2 × 4 texels
    std::fill_n(sky.begin(), 6, 3.0f);
    builder.set_environment(2, 4, sky);
    return builder.build();
}

Image picture_of(const Scene& scene, const char* method, int samples, std::uint64_t seed = 0) {
    RenderSettings settings;
    settings.method = method;
    settings.width = settings.height = 32;
    settings.samples_per_pixel = samples;
    settings.gather_rays = 16;
    settings.seed = seed;
    return render(scene, settings);
}

/// Metal that is nearly a mirror (GGX α .0036). The maps' integral alone finds between nothing and twice what
/// it reflects, in stripes.
TEST(CacheOfSharpLobes, ShowsWhatTheyReflect) {
    MaterialDescription metal;
    metal.metallic = 1;
    metal.roughness = 0.06f;
    const Scene scene = under_a_sky(floor_of(metal));
    const std::vector<double> expected = block_means(picture_of(scene, "gather", 4), 8),
                              found = block_means(picture_of(scene, "cache", 4), 8);
    for (std::size_t i = 0; i < found.size(); ++i) EXPECT_NEAR(found[i] / expected[i], 1, 0.01) << i;
}

/// Glaze (GGX α .0144 over white). With the whole surface left to rays, two renders differ by 12 %.
TEST(CacheOfSharpLobes, FiltersWhatIsUnderThem) {
    MaterialDescription glaze;
    glaze.roughness = 0.12f;
    const Scene scene = under_a_sky(floor_of(glaze));
    const std::vector<float> a = picture_of(scene, "cache", 4, 1).layer()->pixels,
                             b = picture_of(scene, "cache", 4, 2).layer()->pixels;
    double difference = 0, sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) difference += std::abs(a[i] - b[i]), sum += a[i];
    EXPECT_LT(difference / sum, 0.01);
}

/// Under a lamp and a sky.
Scene lit_floor(float metallic) {
    MaterialDescription glaze, lamp;
    glaze.metallic = metallic;
    glaze.roughness = 0.12f;
    lamp.emission = {10, 10, 10};
    lamp.base_color = {0, 0, 0};  // or paths that go on from metal would see what it reflects, too
    SceneBuilder builder = floor_of(glaze);
    add_quad(builder, {{{-1, 2, -5}, {1, 2, -5}, {1, 3, -4}, {-1, 3, -4}}}, lamp);
    PointLightDescription point;
    point.position = {0, 1, -3};
    point.intensity = {0.03f, 0.03f, 0.03f};
    builder.add_light(point);
    return under_a_sky(std::move(builder));
}

class CacheOfLitLobes : public ::testing::TestWithParam<float> {};

INSTANTIATE_TEST_SUITE_P(Metallic, CacheOfLitLobes, ::testing::Values(0.5f, 1.0f));

/// Rays along the lobes and what is under them add up to the whole: half metal, half white (GGX α .0144); so
/// do paths that go on from metal alone. Welch; a planted bias of 1 % must be caught.
TEST_P(CacheOfLitLobes, AreUnbiasedWhereAsked) {
    const Scene scene = lit_floor(GetParam());
    const Case lit{"", "", "", "emission", -1};
    const Estimate expected = whole(render_seeds(scene, gathered(lit), 24)),
                   mean = whole(render_seeds(scene, unbiased(lit), 64));
    EXPECT_GT(welch_p(mean, expected), false_positive_rate) << mean.mean << " " << expected.mean;
    for (const double scale : {0.99, 1.01})
        EXPECT_LT(welch_p({scale * mean.mean, scale * mean.standard_error, mean.count}, expected),
                  false_positive_rate)
            << scale;
}

/// A matte wall under a lamp in a floor of metal (GGX α .0036): two renders, .7 % apart (4.3 % when
/// gather rays along the lobe met the radiance field's elements).
TEST(CacheOfNearMirrors, IsAsCleanAsWhatTheyShow) {
    MaterialDescription metal, wall, lamp;
    metal.metallic = 1;
    metal.roughness = 0.06f;
    metal.base_color = {0.9f, 0.9f, 0.9f};
    lamp.emission = {20, 20, 20};
    SceneBuilder builder = floor_of(metal);
    add_quad(builder, {{{-9, -1, -6}, {9, -1, -6}, {9, 9, -6}, {-9, 9, -6}}}, wall);
    add_quad(builder, {{{-1, 4, -4}, {1, 4, -4}, {1, 4, -3}, {-1, 4, -3}}}, lamp);
    const Scene scene = builder.build();
    const std::vector<double> a = block_means(picture_of(scene, "cache", 4, 1), 8),
                              b = block_means(picture_of(scene, "cache", 4, 2), 8),
                              expected = block_means(picture_of(scene, "path", 256), 8);
    double difference = 0, error = 0, sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        difference += std::abs(a[i] - b[i]);
        error += a[i] + b[i] - 2 * expected[i];
        sum += 2 * expected[i];
    }
    EXPECT_LT(difference / sum, 0.01);
    EXPECT_NEAR(error / sum, 0, 0.01);
}

/// A ball of glass (GGX α .01): a thin shell, and a body before a lamp.
TEST(CacheOfNearlySmoothGlass, GoesOnAsFromSmoothGlass) {
    MaterialDescription glass, lamp;
    glass.transmission = 1;
    glass.roughness = 0.1f;
    glass.base_color = {1, 1, 1};
    lamp.emission = {9, 9, 9};
    lamp.base_color = {0, 0, 0};
    for (const bool lit : {false, true}) {
        glass.solid = lit;
        SceneBuilder builder;
        const Sphere ball = sphere(32);
        MeshDescription body;
        body.positions = body.normals = ball.positions;
        body.triangles = ball.triangles;
        body.material = builder.add_material(glass);
        builder.add_instance(builder.add_mesh(body));
        if (lit) add_quad(builder, {{{-3, -3, -4}, {3, -3, -4}, {3, 3, -4}, {-3, 3, -4}}}, lamp);
        CameraDescription camera;
        camera.world_from_camera = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 4, 1};
        builder.add_camera(camera);
        const Scene scene = under_a_sky(std::move(builder));
        const std::vector<double> expected = block_means(picture_of(scene, "path", 256), 8),
                                  found = block_means(picture_of(scene, "cache", 64), 8);
        for (std::size_t i = 0; i < found.size(); ++i)
            EXPECT_NEAR(found[i] / expected[i], 1, 0.05) << lit << " " << i;
    }
}

/// A lamp in a ball of metal (GGX α .04) and nothing else: what is dark beside its reflection stays dark.
/// Filtered, the dark was 8.2 times as bright and the reflection lacked 15 %; its noise is some 4 %.
TEST(CacheOfGlossyLobes, ShowsLampsWithoutAHalo) {
    MaterialDescription metal, lamp;
    metal.metallic = 1;
    metal.roughness = 0.2f;
    metal.base_color = {1, 1, 1};
    lamp.emission = {100, 100, 100};
    SceneBuilder builder;
    const Sphere ball = sphere(32);
    MeshDescription body;
    body.positions = body.normals = ball.positions;
    body.triangles = ball.triangles;
    body.material = builder.add_material(metal);
    builder.add_instance(builder.add_mesh(body));
    add_quad(builder, {{{-1, 4, -1}, {1, 4, -1}, {1, 4, 1}, {-1, 4, 1}}}, lamp);
    CameraDescription camera;
    camera.world_from_camera = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 4, 1};
    builder.add_camera(camera);
    const Scene scene = builder.build();
    const std::vector<float> expected = picture_of(scene, "path", 256).layer()->pixels,
                             found = picture_of(scene, "cache", 16).layer()->pixels;
    const float brightest = *std::ranges::max_element(expected);
    double dark = 0, found_dark = 0, bright = 0, found_bright = 0;
    for (std::size_t i = 0; i < found.size(); ++i) {
        const bool is_dark = expected[i] < 0.02f * brightest;
        (is_dark ? dark : bright) += expected[i];
        (is_dark ? found_dark : found_bright) += found[i];
    }
    EXPECT_NEAR(found_dark / dark, 1, 0.1);
    EXPECT_NEAR(found_bright / bright, 1, 0.1);
}

}  // namespace
}  // namespace relumine
