// SPDX-License-Identifier: Apache-2.0
// Where things stand in pbrt scenes: transforms, files, sides and shapes.
#include "scene/pbrt_test_scenes.hpp"
#include "scene/pbrt_transform.hpp"

namespace relumine {
namespace {

using namespace test::pbrt;
using test::TempFolder;

/// The unit normal on the side from which the triangle is counter-clockwise: where our emission goes.
Vec3 front(const SceneData& scene, std::size_t mesh = 0, std::size_t index = 0) {
    const Mesh& m = scene.meshes[mesh];
    const auto [a, b, c] = m.triangles[index].vertex;
    return normalize(cross(m.positions[b] - m.positions[a], m.positions[c] - m.positions[a]));
}

TEST(PbrtTransforms, LaterOnesActFirst) {
    const SceneData scene = finished(std::string{"Translate 1 0 0 Rotate 90 0 0 1\n"} + triangle);
    expect_near(scene.meshes[0].positions[1], {1, 1, 0});
    const SceneData other = finished(std::string{"Rotate 90 0 0 1 Translate 1 0 0\n"} + triangle);
    expect_near(other.meshes[0].positions[1], {0, 2, 0});
}

TEST(PbrtTransforms, MatricesComeColumnByColumn) {
    const SceneData scene =
        finished(std::string{"Scale 9 9 9 Transform [1 0 0 0  0 1 0 0  0 0 1 0  5 6 7 1]\n"} + triangle);
    expect_near(scene.meshes[0].positions[1], {6, 6, 7});
    const SceneData both = finished(
        std::string{"Scale 2 2 2 ConcatTransform [1 0 0 0  0 1 0 0  0 0 1 0  5 6 7 1]\n"} + triangle);
    expect_near(both.meshes[0].positions[1], {12, 12, 14});
}

TEST(PbrtTransforms, AttributesRestoreAndNamesReturn) {
    const SceneData scene = finished(std::string{"Translate 1 0 0 CoordinateSystem \"a\"\n"
                                                 "AttributeBegin Translate 5 5 5 AttributeEnd\n"}
                                     + triangle + "Identity CoordSysTransform \"a\"\n" + triangle
                                     + "CoordSysTransform \"world\"\n" + triangle);
    expect_near(scene.meshes[0].positions[0], {1, 0, 0});
    expect_near(scene.meshes[1].positions[0], {1, 0, 0});
    expect_near(scene.meshes[2].positions[0], {0, 0, 0});
}

TEST(PbrtTransforms, InverseUndoes) {
    const Transform t = pbrt_translate({1, 2, 3}) * pbrt_rotate(40, {1, 2, 0}) * pbrt_scale({2, -3, 0.5});
    const Transform product = t * *inverse(t);
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 4; ++j) EXPECT_NEAR(product.m[i][j], i == j ? 1 : 0, 1e-12);
    EXPECT_FALSE(inverse(pbrt_scale({1, 0, 1})));
}

TEST(PbrtTransforms, InstancesStandOnTheirDefinition) {
    const SceneData scene = finished(std::string{"Translate 0 0 1 ObjectBegin \"a\" Scale 2 2 2\n"} + triangle
                                     + "ObjectEnd Identity\n"
                                       "Translate 10 0 0 ObjectInstance \"a\" Translate 10 0 0 ObjectInstance \"a\"");
    ASSERT_EQ(scene.instances.size(), 2u);
    ASSERT_EQ(scene.meshes.size(), 1u);
    expect_near(scene.instances[0].world_from_object.point(scene.meshes[0].positions[1]), {12, 0, 1});
    expect_near(scene.instances[1].world_from_object.point(scene.meshes[0].positions[1]), {22, 0, 1});
}

TEST(PbrtFilesTogether, IncludeSharesTheStateAndImportDoesNot) {
    const TempFolder folder;
    (void)folder.write("parts/move.pbrt", "Translate 1 0 0\nMaterial \"conductor\"\n");
    const SceneData included =
        finish_scene(read(folder, std::string{"Include \"parts/move.pbrt\"\n"} + triangle));
    expect_near(included.meshes[0].positions[0], {1, 0, 0});
    EXPECT_EQ(included.materials[0].metallic, 1);
    const SceneData imported =
        finish_scene(read(folder, std::string{"Import \"parts/move.pbrt\"\n"} + triangle));
    expect_near(imported.meshes[0].positions[0], {0, 0, 0});
    EXPECT_EQ(imported.materials[0].metallic, 0);
}

TEST(PbrtFilesTogether, NamesBesideTheIncludingFileAreFound) {
    const TempFolder folder;
    (void)folder.write("parts/inner.pbrt", triangle);
    (void)folder.write("parts/outer.pbrt", "Include \"inner.pbrt\"");
    EXPECT_EQ(read(folder, "Include \"parts/outer.pbrt\"").meshes.size(), 1u);
}

TEST(PbrtSides, FollowPbrtsNormals) {
    const auto lit = [](const std::string& before, const std::string& after = "") {
        return front(finished("AreaLightSource \"diffuse\" " + before + '\n' + triangle + after));
    };
    expect_near(lit(""), {0, 0, 1});
    expect_near(lit("ReverseOrientation"), {0, 0, -1});
    expect_near(lit("Scale -1 1 1"), {0, 0, 1});  // pbrt flips the algebraic normal where handedness swaps
    expect_near(lit("ReverseOrientation Scale -1 1 1"), {0, 0, -1});
}

TEST(PbrtSides, VertexNormalsDecide) {
    const std::string mesh =
        "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"normal N\" [0 0 -1 0 0 -1 0 0 -1]";
    expect_near(front(finished(mesh)), {0, 0, -1});
    expect_near(front(finished("ReverseOrientation " + mesh)), {0, 0, 1});
}

TEST(PbrtSides, QuadricsFaceOutwards) {
    for (const char* shape : {"sphere", "cylinder"}) {
        const SceneData scene = finished(std::string{"Shape \""} + shape + "\"");
        for (std::size_t i = 0; i < scene.meshes[0].triangles.size(); i += 97) {
            const Vec3 p = scene.meshes[0].positions[scene.meshes[0].triangles[i].vertex[0]];
            EXPECT_GT(dot(front(scene, 0, i), Vec3{p.x, p.y, 0.5f * p.z}), 0) << shape << i;
        }
    }
    expect_near(front(finished("Shape \"disk\"")), {0, 0, 1});
    expect_near(front(finished("ReverseOrientation Shape \"disk\"")), {0, 0, -1});
    expect_near(front(finished("Shape \"bilinearmesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0 1 1 0]")), {0, 0, 1});
}

double area(const SceneData& scene) {
    double sum = 0;
    for (const Triangle& t : scene.meshes[0].triangles) {
        const auto& p = scene.meshes[0].positions;
        sum += 0.5 * double{length(cross(p[t.vertex[1]] - p[t.vertex[0]], p[t.vertex[2]] - p[t.vertex[0]]))};
    }
    return sum;
}

TEST(PbrtShapes, HaveTheirAreas) {
    constexpr double pi_d = 3.14159265358979;
    EXPECT_NEAR(area(finished("Shape \"sphere\" \"float radius\" 2")), 16 * pi_d, 16 * pi_d * 3e-4);
    EXPECT_NEAR(area(finished("Shape \"sphere\" \"float zmin\" 0")), 2 * pi_d, 2 * pi_d * 3e-4);
    EXPECT_NEAR(area(finished("Shape \"sphere\" \"float phimax\" 90")), pi_d, pi_d * 3e-4);
    EXPECT_NEAR(area(finished("Shape \"disk\" \"float radius\" 2 \"float innerradius\" 1")), 3 * pi_d, 3e-3);
    EXPECT_NEAR(area(finished("Shape \"cylinder\" \"float zmax\" 2")), 6 * pi_d, 6e-3);
    EXPECT_NEAR(area(finished("Shape \"bilinearmesh\" \"point3 P\" [0 0 0 2 0 0 0 3 0 2 3 0]")), 6, 1e-5);
}

TEST(PbrtShapes, CoordinatesGrowAsInPbrt) {
    const SceneData scene = read("Shape \"sphere\"");
    for (std::size_t i = 0; i < scene.meshes[0].positions.size(); i += 111) {
        const Vec3 p = scene.meshes[0].positions[i];
        const Vec2 uv = scene.meshes[0].uvs[0][i];
        const float v = 1 - uv.y;  // 0 at the bottom
        EXPECT_NEAR(p.z, -std::cos(pi * v), 1e-5f);
        if (v > 0.01f && v < 0.99f) {
            EXPECT_NEAR(p.x, std::sin(pi * v) * std::cos(2 * pi * uv.x), 1e-5f);
            EXPECT_NEAR(p.y, std::sin(pi * v) * std::sin(2 * pi * uv.x), 1e-5f);
        }
    }
}

TEST(PbrtShapes, SubdivisionOfAnIcosahedronIsRound) {
    const SceneData scene = finished(
        "Shape \"loopsubdiv\" \"integer levels\" 3 \"point3 P\" [0 1 1.618 0 -1 1.618 0 1 -1.618 0 -1 -1.618 "
        "1 1.618 0 -1 1.618 0 1 -1.618 0 -1 -1.618 0 1.618 0 1 -1.618 0 1 1.618 0 -1 -1.618 0 -1] "
        "\"integer indices\" [0 1 8 0 8 4 0 4 5 0 5 9 0 9 1 3 2 10 3 10 6 3 6 7 3 7 11 3 11 2 "
        "1 6 8 8 10 4 4 2 5 5 11 9 9 7 1 10 8 6 2 4 10 11 5 2 7 9 11 6 1 7]");
    const Mesh& mesh = scene.meshes[0];
    EXPECT_EQ(mesh.triangles.size(), 20u * 64u);
    float least = infinity, most = 0;
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        least = std::min(least, length(mesh.positions[i]));
        most = std::max(most, length(mesh.positions[i]));
        EXPECT_GT(std::abs(dot(mesh.normals[i], normalize(mesh.positions[i]))), 0.99f);
    }
    EXPECT_GT(least / most, 0.97f);
}

TEST(PbrtShapes, ReadsPlyPackedOrNot) {
    const TempFolder folder;
    (void)folder.write(
        "a.ply",
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty "
        "float z\nproperty float u\nproperty float v\nelement face 1\nproperty list uchar int "
        "vertex_indices\nend_header\n0 0 0 0 0\n1 0 0 1 0\n1 1 0 1 1\n0 1 0 0 1\n4 0 1 2 3\n");
    const SceneData scene = read(folder, "Shape \"plymesh\" \"string filename\" \"a.ply\"");
    ASSERT_EQ(scene.meshes.size(), 1u);
    EXPECT_EQ(scene.meshes[0].triangles.size(), 2u);
    EXPECT_EQ(scene.meshes[0].uvs[0][0], (Vec2{0, 1}));
    ASSERT_EQ(std::system(("gzip -k " + folder.path("a.ply")).c_str()), 0);
    EXPECT_EQ(read(folder, "Shape \"plymesh\" \"string filename\" \"a.ply.gz\"").meshes[0].triangles.size(),
              2u);
}

TEST(PbrtShapes, CurvesAreLeftOutWithAWarning) {
    const SceneData scene =
        read(std::string{triangle} + "Shape \"curve\" \"point3 P\" [0 0 0 1 0 0 2 0 0 3 0 0]");
    EXPECT_EQ(scene.meshes.size(), 1u);
    EXPECT_TRUE(warns(scene, "scene.pbrt:4:1: shape \"curve\" is not supported"));
}

TEST(PbrtOptions, WhatTheCommandDecidesIsRepeated) {
    const auto says = [](const std::string& options, const std::string& text) {
        return warns(read(triangle, options), text);
    };
    EXPECT_TRUE(says("Sampler \"zsobol\" \"integer pixelsamples\" 64", "--spp 64"));
    EXPECT_TRUE(says("Sampler \"stratified\" \"integer xsamples\" 3", "--spp 12"));
    EXPECT_FALSE(says("Sampler \"zsobol\"", "--spp"));
    EXPECT_TRUE(says("Integrator \"volpath\" \"integer maxdepth\" 7", "--max-depth 7"));
}

}  // namespace
}  // namespace relumine
