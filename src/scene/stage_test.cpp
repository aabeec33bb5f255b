// SPDX-License-Identifier: Apache-2.0
// The stage for models that come alone: ground, sky, camera and normals.
#include <gtest/gtest.h>

#include "scene/finish_scene.hpp"
#include "scene/mesh_normals.hpp"

namespace relumine {
namespace {

/// The unit cube with eight shared corners, sides outwards.
Mesh cube() {
    Mesh mesh;
    mesh.name = "cube";
    for (int i = 0; i < 8; ++i)
        mesh.positions.push_back(
            {static_cast<float>(i & 1), static_cast<float>(i >> 1 & 1), static_cast<float>(i >> 2)});
    for (const auto& [a, b, c, d] : std::vector<std::array<std::uint32_t, 4>>{
             {0, 2, 3, 1}, {4, 5, 7, 6}, {0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}}) {
        mesh.triangles.push_back({{a, b, c}});
        mesh.triangles.push_back({{a, c, d}});
    }
    return mesh;
}

/// A sphere of 32 × 16 cells, without its poles.
Mesh sphere() {
    Mesh mesh;
    constexpr std::uint32_t columns = 32, rows = 16;
    for (std::uint32_t row = 1; row < rows; ++row) {
        for (std::uint32_t column = 0; column < columns; ++column) {
            const float theta = pi * static_cast<float>(row) / rows,
                        phi = 2 * pi * static_cast<float>(column) / columns;
            mesh.positions.push_back(
                {std::sin(theta) * std::cos(phi), std::cos(theta), std::sin(theta) * std::sin(phi)});
        }
    }
    for (std::uint32_t row = 0; row + 2 < rows; ++row) {
        for (std::uint32_t column = 0; column < columns; ++column) {
            const std::uint32_t a = row * columns + column, b = row * columns + (column + 1) % columns;
            mesh.triangles.push_back({{a, b, b + columns}});
            mesh.triangles.push_back({{a, b + columns, a + columns}});
        }
    }
    return mesh;
}

TEST(Stage, PutsTheModelOnWiderGroundUnderASky) {
    const SceneData scene = finish_scene(stage_model(cube()));
    ASSERT_EQ(scene.meshes.size(), 2u);
    ASSERT_EQ(scene.cameras.size(), 1u);
    EXPECT_TRUE(scene.environment.has_value());
    EXPECT_TRUE(scene.warnings.empty());
    const Mesh& ground = scene.meshes[1];
    EXPECT_LT(ground.positions[0].y, 0);
    EXPECT_GT(ground.positions[0].y, -0.01f);
    EXPECT_GT(scene.bounds.upper.x, 20);
    for (const Triangle& triangle : ground.triangles) EXPECT_GT(area_vector(ground, triangle).y, 0);
    EXPECT_EQ(scene.materials[1].base_color, Spectrum{0.4f});
    EXPECT_EQ(scene.materials[1].specular, 0);
}

TEST(Stage, CameraFramesTheModelAlone) {
    const Camera camera = stage_model(cube()).cameras.at(0);
    EXPECT_LT(length(camera.world_from_camera.point({0, 0, 0}) - Vec3{0.5f, 0.5f, 0.5f}), 4);
}

TEST(Stage, BoxesKeepTheirEdges) {
    Mesh mesh = cube();
    add_creased_normals(mesh);
    ASSERT_EQ(mesh.normals.size(), mesh.positions.size());
    for (const Triangle& triangle : mesh.triangles) {
        const Vec3 flat = normalize(area_vector(mesh, triangle));
        for (const std::uint32_t vertex : triangle.vertex) EXPECT_GT(dot(mesh.normals[vertex], flat), 0.999f);
    }
}

TEST(Stage, SpheresBecomeSmooth) {
    Mesh mesh = sphere();
    const std::size_t vertices = mesh.positions.size();
    add_creased_normals(mesh);
    EXPECT_EQ(mesh.positions.size(), vertices);  // nothing was split
    for (std::size_t i = 0; i < vertices; ++i) EXPECT_GT(dot(mesh.normals[i], mesh.positions[i]), 0.98f);
}

TEST(Stage, KeepsTheNormalsOfTheFile) {
    Mesh mesh = cube();
    mesh.normals.assign(8, {0, 1, 0});
    EXPECT_EQ(stage_model(mesh).meshes.at(0).normals, mesh.normals);
}

TEST(Stage, SkyHasAMeanRadianceOfAboutOneAndASunAtTheUpperLeftFront) {
    const Environment sky = builtin_sky();
    double weight = 0, sum = 0;
    std::size_t brightest = 0;
    for (std::size_t i = 0; i < sky.radiance.size(); ++i) {
        const double row = static_cast<double>(i / static_cast<std::size_t>(sky.width));
        const double area = std::sin(3.14159265 * (row + 0.5) / sky.height);  // of the texel, relative
        weight += area;
        sum += area * static_cast<double>(luminance(sky.radiance[i]));
        if (luminance(sky.radiance[i]) > luminance(sky.radiance[brightest])) brightest = i;
        ASSERT_GE(sky.radiance[i].r, 0);
    }
    EXPECT_NEAR(sum / weight, 1, 0.25);
    const float u = (static_cast<float>(brightest % 256) + 0.5f) / 256,
                v = (static_cast<float>(brightest) / 256 + 0.5f) / 128;
    EXPECT_LT(v, 0.4f);                           // up
    EXPECT_LT(std::cos(2 * pi * (u - 0.5f)), 0);  // −X: left
    EXPECT_GT(std::sin(2 * pi * (u - 0.5f)), 0);  // +Z: front
}

}  // namespace
}  // namespace relumine
