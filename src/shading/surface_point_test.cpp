// SPDX-License-Identifier: Apache-2.0
// Where the lobes of anisotropic materials point.
#include "shading/surface_point.hpp"

#include <gtest/gtest.h>

#include "scene/finish_scene.hpp"

namespace relumine {
namespace {

/// A triangle in the plane z = 0 that faces +Z, whose u grows along +Y and v (downwards in pictures) along
/// +X.
SceneData brushed_triangle() {
    SceneData scene;
    scene.name = "test";
    Material material;
    material.anisotropy = 0.5f;
    scene.materials.push_back(material);
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.uvs[0] = {{0, 0}, {0, 1}, {1, 0}};
    mesh.triangles = {{{0, 1, 2}}};
    scene.meshes.push_back(mesh);
    scene.instances.push_back({MeshId{0}, {}, false});
    return scene;
}

/// The s axis of the shading frame, seen from +Z or −Z.
Vec3 axis(SceneData scene, float side = 1) {
    const SceneData finished = finish_scene(std::move(scene));
    const SurfacePoint p = surface_point(finished, {0, 0.25f, 0.25f, 0, 0}, {{0, 0, side}});
    EXPECT_NEAR(dot(p.frame.s, p.frame.n), 0, 1e-6f);
    EXPECT_NEAR(length(cross(p.frame.s, p.frame.t) - p.frame.n), 0, 1e-6f);
    EXPECT_NEAR(p.frame.n.z, side, 1e-6f);
    return p.frame.s;
}

/// As an axis: without a sign.
void expect_along(Vec3 found, Vec3 wanted) {
    EXPECT_NEAR(std::abs(dot(found, normalize(wanted))), 1, 1e-5f)
        << found.x << ' ' << found.y << ' ' << found.z;
}

TEST(LobeAxis, IsWhereUGrows) {
    SceneData scene = brushed_triangle();
    expect_along(axis(scene), {0, 1, 0});
    expect_along(axis(scene, -1), {0, 1, 0});
    scene.meshes[0].facet_tangents = true;
    expect_along(axis(scene), {0, 1, 0});
}

TEST(LobeAxis, TangentsComeFirst) {
    SceneData scene = brushed_triangle();
    scene.meshes[0].tangents = {3, Vec4{0.6f, 0.8f, 0, 1}};
    expect_along(axis(scene), {3, 4, 0});
}

TEST(LobeAxis, TurnsFromTheTangentTowardsTheBitangent) {
    SceneData scene = brushed_triangle();
    scene.materials[0].anisotropy_rotation = 0.5f;
    scene.meshes[0].tangents = {3, Vec4{1, 0, 0, 1}};  // bitangent: n × t = +Y
    expect_along(axis(scene), {std::cos(0.5f), std::sin(0.5f), 0});
    expect_along(axis(scene, -1), {std::cos(0.5f), std::sin(0.5f), 0});
    scene.meshes[0].tangents = {3, Vec4{1, 0, 0, -1}};
    expect_along(axis(scene), {std::cos(0.5f), -std::sin(0.5f), 0});
}

TEST(LobeAxis, FollowsTheTexturesDirection) {
    SceneData scene = brushed_triangle();
    ByteImage image;
    image.width = image.height = 1;
    image.rgba8 = {255, 255, 255, 255};  // the direction (1, 1)
    scene.images.push_back(image);
    scene.materials[0].anisotropy_texture = TextureRef{};
    scene.meshes[0].tangents = {3, Vec4{1, 0, 0, 1}};
    expect_along(axis(scene), {1, 1, 0});
    scene.materials[0].anisotropy_rotation = pi / 4;
    expect_along(axis(scene), {0, 1, 0});
}

TEST(LobeAxis, MovesWithInstances) {
    for (const float mirror : {1.0f, -1.0f}) {
        SceneData scene = brushed_triangle();
        scene.materials[0].anisotropy_rotation = 0.5f;
        scene.meshes[0].tangents = {3, Vec4{1, 0, 0, 1}};
        Transform t;
        t.m = {{{0, double{-mirror}, 0, 0}, {1, 0, 0, 0}, {0, 0, double{mirror}, 0}}};  // X → Y, Y → ∓X
        scene.instances[0].world_from_object = t;
        const Vec3 wanted{-mirror * std::sin(0.5f), std::cos(0.5f), 0};
        expect_along(axis(scene), wanted);
        scene.instances.push_back(scene.instances[0]);  // not brought to world space
        expect_along(axis(scene), wanted);
    }
}

TEST(LobeAxis, NeedsNoTextureCoordinates) {
    SceneData scene = brushed_triangle();
    scene.meshes[0].uvs[0].clear();
    EXPECT_NEAR(length(axis(scene)), 1, 1e-6f);
}

TEST(LobeAxis, IsOfNoConcernToIsotropicMaterials) {
    SceneData scene = brushed_triangle();
    scene.materials[0].anisotropy = 0;
    const Vec3 s = axis(scene), usual = frame_around({0, 0, 1}).s;
    EXPECT_EQ(s, usual);
    EXPECT_EQ(shading_triangle(finish_scene(scene), {0, 0.25f, 0.25f, 0, 0}).lobe_axis, Vec3{});
}

}  // namespace
}  // namespace relumine
