// SPDX-License-Identifier: Apache-2.0
// Caustics by photons: as much light as `path` finds, none of it twice.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/render_support.hpp"

namespace relumine {
namespace {

using testing::mean_of;

using Point = std::array<float, 3>;

void add_quad(SceneBuilder& builder, std::size_t material, const Point& a, const Point& b, const Point& c,
              const Point& d) {
    const std::array positions{a, b, c, d};
    const std::array<std::array<std::uint32_t, 3>, 2> triangles{{{0, 1, 2}, {0, 2, 3}}};
    MeshDescription mesh;
    mesh.positions = positions;
    mesh.triangles = triangles;
    mesh.material = material;
    builder.add_instance(builder.add_mesh(mesh));
}

/// A lamp over a matte floor between two mirrors that face each other, seen from above.
Scene mirrors(float roughness) {
    SceneBuilder builder;
    MaterialDescription matte, lamp, mirror;
    matte.specular = lamp.specular = 0;
    matte.base_color = lamp.base_color = {0.5f, 0.5f, 0.5f};
    lamp.emission = {10, 10, 10};
    mirror.metallic = 1;
    mirror.base_color = {0.9f, 0.9f, 0.9f};
    mirror.roughness = roughness;
    const std::size_t floor = builder.add_material(matte), light = builder.add_material(lamp),
                      silver = builder.add_material(mirror);
    add_quad(builder, floor, {-1, 0, -1}, {-1, 0, 1}, {1, 0, 1}, {1, 0, -1});
    add_quad(builder, light, {-0.2f, 1, -0.2f}, {0.2f, 1, -0.2f}, {0.2f, 1, 0.2f}, {-0.2f, 1, 0.2f});
    add_quad(builder, silver, {-1, 0, -1}, {-1, 1, -1}, {-1, 1, 1}, {-1, 0, 1});
    add_quad(builder, silver, {1, 0, -1}, {1, 0, 1}, {1, 1, 1}, {1, 1, -1});
    CameraDescription camera;  // looks down from below the lamp
    camera.world_from_camera = {1, 0, 0, 0, 0, 0, -1, 0, 0, 1, 0, 0, 0, 0.95, 0, 1};
    camera.vertical_fov = 1.4;
    builder.add_camera(camera);
    return builder.build();
}

/// A sphere with the vertices' normals.
void add_sphere(SceneBuilder& builder, std::size_t material, const Point& center, float radius) {
    constexpr std::uint32_t rows = 48, columns = 96;
    std::vector<Point> positions, normals;
    std::vector<std::array<std::uint32_t, 3>> triangles;
    for (std::uint32_t i = 0; i <= rows; ++i)
        for (std::uint32_t j = 0; j <= columns; ++j) {
            const double theta = 3.141592653589793 * i / rows, phi = 2 * 3.141592653589793 * j / columns;
            const Point n{static_cast<float>(std::sin(theta) * std::cos(phi)),
                          static_cast<float>(std::cos(theta)),
                          static_cast<float>(std::sin(theta) * std::sin(phi))};
            normals.push_back(n);
            positions.push_back(
                {center[0] + radius * n[0], center[1] + radius * n[1], center[2] + radius * n[2]});
            if (i == rows || j == columns) continue;
            const std::uint32_t a = i * (columns + 1) + j, b = a + columns + 1;
            if (i > 0) triangles.push_back({a, a + 1, b});
            if (i + 1 < rows) triangles.push_back({a + 1, b + 1, b});
        }
    MeshDescription mesh;
    mesh.positions = positions;
    mesh.normals = normals;
    mesh.triangles = triangles;
    mesh.material = material;
    builder.add_instance(builder.add_mesh(mesh));
}

/// A ball of glass over a matte floor, under a lamp; the camera sees the floor alone.
Scene glass_ball() {
    SceneBuilder builder;
    MaterialDescription matte, lamp, glass;
    matte.specular = lamp.specular = 0;
    matte.base_color = {0.5f, 0.5f, 0.5f};
    lamp.base_color = {0, 0, 0};
    lamp.emission = {10, 10, 10};
    glass.roughness = 0;
    glass.transmission = 1;
    glass.solid = true;
    add_quad(builder, builder.add_material(matte), {-1, 0, -1}, {-1, 0, 1}, {1, 0, 1}, {1, 0, -1});
    add_quad(builder, builder.add_material(lamp), {-0.3f, 2, -0.3f}, {0.3f, 2, -0.3f}, {0.3f, 2, 0.3f},
             {-0.3f, 2, 0.3f});
    add_sphere(builder, builder.add_material(glass), {0, 0.6f, 0}, 0.3f);
    CameraDescription camera;  // looks down from below the ball
    camera.world_from_camera = {1, 0, 0, 0, 0, 0, -1, 0, 0, 1, 0, 0, 0, 0.25, 0, 1};
    camera.vertical_fov = 1.6;
    builder.add_camera(camera);
    return builder.build();
}

RenderSettings small(const std::string& method, int photons) {
    RenderSettings settings;
    settings.method = method;
    settings.width = settings.height = 24;
    settings.samples_per_pixel = 16;
    settings.gather_rays = 64;
    settings.photons = photons;
    return settings;
}

constexpr int enough = 1 << 17;

class MethodsWithPhotons : public ::testing::TestWithParam<std::tuple<const char*, float>> {};
INSTANTIATE_TEST_SUITE_P(Caustics, MethodsWithPhotons,
                         ::testing::Combine(::testing::Values("gather", "cache"),
                                            ::testing::Values(0.0f, 0.25f)));

/// A tenth of the light and more has met one mirror, so counting it twice or never would show.
TEST_P(MethodsWithPhotons, TheMeanIsThatOfPath) {
    const auto [method, roughness] = GetParam();
    const Scene scene = mirrors(roughness);
    RenderSettings path = small("path", 0);
    path.samples_per_pixel = 1024;
    const double truth = mean_of(render(scene, path));
    EXPECT_NEAR(mean_of(render(scene, small(method, enough))) / truth, 1, 0.01);
    path.samples_per_pixel = 64;
    const auto up_to = [&](int depth) {
        path.max_depth = depth;
        return mean_of(render(scene, path));
    };
    EXPECT_GT((up_to(2) - up_to(1)) / truth, 0.1);
}

TEST(Caustics, GlassFocusesWhatPathFinds) {
    const Scene scene = glass_ball();
    RenderSettings path = small("path", 0);
    path.samples_per_pixel = 2048;
    const double truth = mean_of(render(scene, path));
    EXPECT_NEAR(mean_of(render(scene, small("gather", enough))) / truth, 1, 0.015);
    path.samples_per_pixel = 64;
    path.max_depth = 1;  // without the light through the glass
    EXPECT_LT(mean_of(render(scene, path)) / truth, 0.8);
}

TEST(Caustics, AreTheSameForAnyNumberOfThreads) {
    const Scene scene = mirrors(0);
    RenderSettings settings = small("gather", 5000);
    settings.samples_per_pixel = 1;
    settings.threads = 1;
    const double one = mean_of(render(scene, settings));
    settings.threads = 3;
    EXPECT_EQ(one, mean_of(render(scene, settings)));
}

}  // namespace
}  // namespace relumine
