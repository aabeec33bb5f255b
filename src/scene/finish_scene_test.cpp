// SPDX-License-Identifier: Apache-2.0
// What finish_scene guarantees, repairs and refuses.
#include "scene/finish_scene.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "relumine/error.hpp"
#include "scene/mesh_normals.hpp"
#include "scene/tangents.hpp"

namespace relumine {
namespace {

constexpr float nan = std::numeric_limits<float>::quiet_NaN();

/// One triangle in the plane z = 0 that faces +Z, with one white material, without light or camera.
SceneData triangle_scene() {
    SceneData scene;
    scene.name = "test";
    scene.materials.emplace_back();
    Mesh mesh;
    mesh.name = "triangle";
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.triangles = {{{0, 1, 2}}};
    scene.meshes.push_back(mesh);
    scene.instances.push_back({MeshId{0}, {}, false});
    return scene;
}

bool has_warning(const SceneData& scene, const std::string& part) {
    return std::ranges::any_of(scene.warnings, [&](const std::string& w) { return w.find(part) != w.npos; });
}

Transform scaled(double x, double y, double z) {
    Transform t;
    t.m[0][0] = x;
    t.m[1][1] = y;
    t.m[2][2] = z;
    return t;
}

void expect_near(Vec3 a, Vec3 b) {
    EXPECT_NEAR(a.x, b.x, 1e-6);
    EXPECT_NEAR(a.y, b.y, 1e-6);
    EXPECT_NEAR(a.z, b.z, 1e-6);
}

TEST(FinishScene, MovesSingleInstancesToWorldSpace) {
    SceneData scene = triangle_scene();
    scene.instances[0].world_from_object = scaled(2, 3, 4);
    scene.instances[0].world_from_object.m[2][3] = 5;
    scene = finish_scene(std::move(scene));
    EXPECT_TRUE(scene.instances[0].identity);
    EXPECT_EQ(scene.instances[0].world_from_object, Transform{});
    EXPECT_EQ(scene.meshes[0].positions[1], (Vec3{2, 0, 5}));
    EXPECT_EQ(scene.bounds.lower, (Vec3{0, 0, 5}));
    EXPECT_EQ(scene.bounds.upper, (Vec3{2, 3, 5}));
}

TEST(FinishScene, KeepsMeshesThatAreInstancedTwice) {
    SceneData scene = triangle_scene();
    scene.instances.push_back(scene.instances[0]);
    scene.instances[1].world_from_object = scaled(-10, 1, 1);
    scene = finish_scene(std::move(scene));
    EXPECT_FALSE(scene.instances[0].identity);
    EXPECT_EQ(scene.meshes[0].positions[1], (Vec3{1, 0, 0}));
    EXPECT_EQ(scene.bounds.lower, (Vec3{-10, 0, 0}));
    EXPECT_EQ(scene.bounds.upper, (Vec3{1, 1, 0}));
}

TEST(FinishScene, MirroringKeepsTheOutwardSide) {
    SceneData scene = triangle_scene();
    scene.meshes[0].normals.assign(3, {0, 0, 1});
    scene.meshes[0].tangents.assign(3, {1, 0, 0, 1});
    scene.instances[0].world_from_object = scaled(-1, 1, 1);  // the normal stays +Z
    scene = finish_scene(std::move(scene));
    const Mesh& mesh = scene.meshes[0];
    expect_near(mesh.normals[0], {0, 0, 1});
    expect_near(normalize(area_vector(mesh, mesh.triangles[0])), {0, 0, 1});
    EXPECT_EQ(mesh.tangents[0], (Vec4{-1, 0, 0, -1}));  // cross(n, t)·w is still +Y
}

TEST(FinishScene, NormalsFollowTheCofactors) {
    SceneData scene = triangle_scene();
    const float root = std::sqrt(0.5f);
    scene.meshes[0].normals.assign(3, {root, 0, root});
    scene.instances[0].world_from_object = scaled(1e-9, 1, 1e9);
    scene = finish_scene(std::move(scene));
    expect_near(scene.meshes[0].normals[0], {1, 0, 0});
}

TEST(FinishScene, LeavesOutTrianglesWithoutArea) {
    SceneData scene = triangle_scene();
    scene.meshes[0].positions.push_back({2, 0, 0});
    scene.meshes[0].triangles.push_back({{0, 1, 3}});
    scene.meshes[0].triangles.push_back({{0, 0, 2}});
    scene = finish_scene(std::move(scene));
    EXPECT_EQ(scene.meshes[0].triangles.size(), 1u);
    EXPECT_EQ(scene.meshes[0].positions.size(), 3u);  // and the vertex that nothing uses any more
    EXPECT_TRUE(has_warning(scene, "2 triangles without area"));
}

TEST(FinishScene, LeavesOutUnusedVerticesOfEveryAttribute) {
    SceneData scene = triangle_scene();
    Mesh& mesh = scene.meshes[0];
    mesh.positions = {{9, nan, 9}, {0, 0, 0}, {9, 9, 9}, {1, 0, 0}, {0, 1, 0}};
    mesh.uvs[0] = {{9, 9}, {0, 0}, {9, 9}, {1, 0}, {0, 1}};
    mesh.colors = {{9, 9, 9, 9}, {0, 0, 0, 1}, {9, 9, 9, 9}, {2, -1, nan, 1}, {0, 0, 0, 1}};
    mesh.triangles = {{{1, 3, 4}}};
    scene = finish_scene(std::move(scene));
    EXPECT_EQ(scene.meshes[0].positions, (std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
    EXPECT_EQ(scene.meshes[0].uvs[0], (std::vector<Vec2>{{0, 0}, {1, 0}, {0, 1}}));
    EXPECT_EQ(scene.meshes[0].colors[1], (std::array<float, 4>{1, 0, 0, 1}));  // clamped
    EXPECT_EQ(scene.meshes[0].triangles[0].vertex, (std::array<std::uint32_t, 3>{0, 1, 2}));
}

TEST(FinishScene, RepairsNormalsAndUvs) {
    SceneData scene = triangle_scene();
    scene.meshes[0].normals = {{0, 0, 0}, {nan, 0, 0}, {0, 3, 0}};
    scene.meshes[0].uvs[0] = {{nan, 0}, {1, 1}, {1, 1}};
    scene = finish_scene(std::move(scene));
    EXPECT_EQ(scene.meshes[0].normals, (std::vector<Vec3>{{0, 0, 1}, {0, 0, 1}, {0, 1, 0}}));
    EXPECT_EQ(scene.meshes[0].uvs[0][0], Vec2{});
    EXPECT_TRUE(has_warning(scene, "2 normals"));
    EXPECT_TRUE(has_warning(scene, "1 texture coordinates"));
}

TEST(FinishScene, LeavesSpareBytesBehindTheLastVertex) {
    const SceneData scene = finish_scene(triangle_scene());
    for (const Mesh& mesh : scene.meshes) EXPECT_GE(mesh.positions.capacity(), mesh.positions.size() + 2);
}

TEST(FinishScene, LeavesOutFlatInstancesAndUnusedMeshes) {
    SceneData scene = triangle_scene();
    scene.meshes.push_back(scene.meshes[0]);
    scene.meshes.push_back(scene.meshes[0]);
    scene.instances = {{MeshId{0}, scaled(1, 0, 1), false}, {MeshId{2}, {}, false}};
    scene = finish_scene(std::move(scene));
    EXPECT_EQ(scene.meshes.size(), 1u);
    ASSERT_EQ(scene.instances.size(), 1u);
    EXPECT_EQ(scene.instances[0].mesh, MeshId{0});
    EXPECT_TRUE(has_warning(scene, "1 instances were scaled flat"));
}

TEST(FinishScene, TinyScalesAreNotFlat) {
    SceneData scene = triangle_scene();
    for (Vec3& p : scene.meshes[0].positions) p = p * 1e9f;
    scene.instances[0].world_from_object = scaled(1e-9, 1e-9, 1e-9);
    EXPECT_EQ(finish_scene(std::move(scene)).meshes.at(0).triangles.size(), 1u);
}

TEST(FinishScene, WarnsOfDarknessAndFramesScenesWithoutCamera) {
    SceneData scene = finish_scene(triangle_scene());
    EXPECT_TRUE(has_warning(scene, "--environment"));
    ASSERT_EQ(scene.cameras.size(), 1u);
    scene = triangle_scene();
    scene.materials[0].emission = Spectrum{1};
    EXPECT_FALSE(has_warning(finish_scene(std::move(scene)), "--environment"));
}

TEST(FinishScene, AllowsRoundingOfFactors) {
    SceneData scene = triangle_scene();
    scene.materials[0].base_color = Spectrum{1.00001f, -0.00001f, 1};
    EXPECT_EQ(finish_scene(std::move(scene)).materials[0].base_color, (Spectrum{1, 0, 1}));
}

TEST(FinishScene, AddsTangentsWhereANormalMapNeedsThem) {
    SceneData scene = triangle_scene();
    scene.images.push_back({1, 1, {128, 128, 255, 255}, {}});
    scene.materials[0].normal_texture = TextureRef{};
    scene.meshes[0].normals.assign(3, {0, 0, 1});
    scene.meshes[0].uvs[0] = {{0, 1}, {2, 1}, {0, 0}};  // u along +X; v shrinks along +Y
    const auto tangents = finish_scene(scene).meshes[0].tangents;
    EXPECT_EQ(tangents, (std::vector<Vec4>(3, Vec4{1, 0, 0, 1})));
    scene.meshes[0].uvs[0] = {{1, 1}, {0, 1}, {1, 0}};  // mirrored
    EXPECT_EQ(finish_scene(scene).meshes[0].tangents, (std::vector<Vec4>(3, Vec4{-1, 0, 0, -1})));
}

TEST(FinishScene, TangentsOfUvsWithoutAreaAreAnyOrthogonalOnes) {
    Mesh mesh = triangle_scene().meshes[0];
    mesh.normals.assign(3, {0, 0, 1});
    mesh.uvs[0].assign(3, {0.5f, 0.5f});
    add_tangents(mesh, 0);
    for (const Vec4& t : mesh.tangents) {
        EXPECT_NEAR(t.z, 0, 1e-6);
        EXPECT_NEAR(t.x * t.x + t.y * t.y, 1, 1e-6);
    }
}

TEST(FinishScene, FramingCameraSeesTheWholeBox) {
    Bounds3 bounds;
    bounds.add({-3, 10, 2});
    bounds.add({5, 11, 7});
    const Camera camera = framing_camera(bounds);
    const Transform& t = camera.world_from_camera;
    const Vec3 eye = t.point({0, 0, 0}), forward = t.vector({0, 0, -1});
    EXPECT_GT(eye.y, bounds.center().y);  // from above
    EXPECT_GT(eye.z, bounds.upper.z);     // and from the front
    for (int corner = 0; corner < 8; ++corner) {
        const Vec3 p{(corner & 1) != 0 ? 5.0f : -3.0f, (corner & 2) != 0 ? 11.0f : 10.0f,
                     (corner & 4) != 0 ? 7.0f : 2.0f};
        const float cos_angle = dot(normalize(p - eye), forward);
        EXPECT_GT(cos_angle, std::cos(camera.vertical_extent / 2));
    }
}

TEST(FinishScene, KeepsAHundredWarningsAndEachOnce) {
    SceneData scene;
    for (int i = 0; i < 300; ++i) scene.warn(std::to_string(i % 200));
    EXPECT_EQ(scene.warnings.size(), 101u);
    EXPECT_NE(scene.warnings.back().find("more warnings"), std::string::npos);
}

/// A change to a sound scene that finish_scene must refuse.
using Damage = void (*)(SceneData& scene);

TEST(FinishScene, RefusesWhatCannotBeRepaired) {
    constexpr float inf = std::numeric_limits<float>::infinity();
    const std::vector<Damage> damages{
        [](SceneData& s) { s.meshes[0].triangles[0].vertex[1] = 3; },
        [](SceneData& s) { s.meshes[0].positions[1].y = nan; },
        [](SceneData& s) { s.meshes[0].positions[1].x = inf; },
        [](SceneData& s) { s.meshes[0].positions[1].x = 2e18f; },
        [](SceneData& s) { s.meshes[0].material = MaterialId{1}; },
        [](SceneData& s) { s.meshes[0].normals.resize(2); },
        [](SceneData& s) { s.meshes[0].tangents.resize(4); },
        [](SceneData& s) { s.meshes[0].uvs[1].resize(1); },
        [](SceneData& s) { s.meshes[0].colors.resize(1); },
        [](SceneData& s) { s.meshes[0].triangles.clear(); },
        [](SceneData& s) { s.meshes.clear(); },
        [](SceneData& s) { s.instances.clear(); },
        [](SceneData& s) { s.instances[0].mesh = MeshId{7}; },
        [](SceneData& s) { s.instances[0].world_from_object.m[0][0] = nan; },
        [](SceneData& s) { s.instances[0].world_from_object.m[0][3] = 1e19; },
        [](SceneData& s) {
            s.instances.push_back(s.instances[0]);
            s.instances[1].world_from_object.m[0][3] = 1e300;
        },
        [](SceneData& s) { s.materials[0].base_color.g = 1.5f; },
        [](SceneData& s) { s.materials[0].base_alpha = -1; },
        [](SceneData& s) { s.materials[0].roughness = nan; },
        [](SceneData& s) { s.materials[0].emission.b = inf; },
        [](SceneData& s) { s.materials[0].ior = 0.9f; },
        [](SceneData& s) { s.materials[0].ior = inf; },
        [](SceneData& s) { s.materials[0].specular_color.r = -1; },
        [](SceneData& s) { s.materials[0].specular_color.r = inf; },
        [](SceneData& s) { s.materials[0].attenuation_distance = 0; },
        [](SceneData& s) { s.materials[0].normal_scale = nan; },
        [](SceneData& s) { s.materials[0].emission_texture = TextureRef{}; },
        [](SceneData& s) {
            s.images.resize(1);
            s.materials[0].emission_texture.emplace().uv_set = 2;
        },
        [](SceneData& s) {
            s.images.resize(1);
            s.materials[0].emission_texture.emplace().turned_away = ImageId{1};
        },
        [](SceneData& s) {
            s.point_lights.push_back({{nan, 0, 0}, Spectrum{1}});
        },
        [](SceneData& s) {
            s.spot_lights.push_back({{}, {0, 0, 1}, Spectrum{-1}});
        },
        [](SceneData& s) {
            s.directional_lights.push_back({{0, 0, 1}, Spectrum{inf}});
        },
        [](SceneData& s) {
            s.environment = Environment{2, 2, std::vector<Spectrum>(3), 0};
        },
        [](SceneData& s) {
            s.environment = Environment{1, 1, std::vector<Spectrum>(1), 0};
        },
        [](SceneData& s) {
            s.environment = Environment{2, 1, std::vector<Spectrum>(2, Spectrum{-1}), 0};
        },
        [](SceneData& s) {
            s.cameras.emplace_back();
            s.cameras[0].vertical_extent = 0;
        },
        [](SceneData& s) {
            s.cameras.emplace_back();
            s.cameras[0].world_from_camera = scaled(1, 0, 1);
        },
    };
    for (std::size_t i = 0; i < damages.size(); ++i) {
        SceneData scene = triangle_scene();
        damages[i](scene);
        EXPECT_THROW((void)finish_scene(std::move(scene)), SceneError) << "damage " << i;
    }
}

}  // namespace
}  // namespace relumine
