// SPDX-License-Identifier: Apache-2.0
// Caustics by photons: as much light as `path` finds, none of it twice.
#include <gtest/gtest.h>

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

/// A lamp over a matte floor between two mirrors of GGX roughness² `alpha` that face each other, seen from
/// above.
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

class Methods : public ::testing::TestWithParam<std::tuple<const char*, float>> {};
INSTANTIATE_TEST_SUITE_P(Caustics, Methods,
                         ::testing::Combine(::testing::Values("gather", "cache"),
                                            ::testing::Values(0.0f, 0.25f)));

/// What mirrors bring is a good part of the picture, so counting it twice or never would show.
TEST_P(Methods, TheMeanIsThatOfPath) {
    const auto [method, roughness] = GetParam();
    const Scene scene = mirrors(roughness);
    RenderSettings path = small("path", 0);
    path.samples_per_pixel = 1024;
    const double truth = mean_of(render(scene, path));
    EXPECT_NEAR(mean_of(render(scene, small(method, enough))) / truth, 1, 0.01);
    EXPECT_NEAR(mean_of(render(scene, small(method, 0))) / truth, 1, 0.02);  // by chance
    path.samples_per_pixel = 64;
    path.max_depth = 1;
    EXPECT_LT(mean_of(render(scene, path)) / truth, 0.9);
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
