// SPDX-License-Identifier: Apache-2.0
// The node hierarchy, lights and cameras from glTF.
#include <gtest/gtest.h>

#include "scene/readers.hpp"
#include "scene/test_files.hpp"

namespace relumine {
namespace {

using nlohmann::json;
using test::GltfBuilder;
using test::TempFolder;

SceneData read(const GltfBuilder& builder) {
    const TempFolder folder;
    return read_gltf(folder.write("scene.gltf", builder.json_text()));
}

void expect_near(Vec3 a, Vec3 b) {
    EXPECT_NEAR(a.x, b.x, 1e-6);
    EXPECT_NEAR(a.y, b.y, 1e-6);
    EXPECT_NEAR(a.z, b.z, 1e-6);
}

/// A triangle whose nodes are these; node 0 is the root.
GltfBuilder with_nodes(const json& nodes) {
    GltfBuilder builder = test::triangle_document();
    builder.document["nodes"] = nodes;
    return builder;
}

constexpr double half_root = 0.70710678118654752;

TEST(GltfNodes, ScalesThenTurnsThenMoves) {
    const SceneData scene = read(with_nodes({{{"mesh", 0},
                                              {"translation", {10, 0, 0}},
                                              {"rotation", {0, 0, half_root, half_root}},  // 90° about Z
                                              {"scale", {2, 3, 1}}}}));
    expect_near(scene.instances.at(0).world_from_object.point({1, 0, 0}), {10, 2, 0});
    expect_near(scene.instances.at(0).world_from_object.point({0, 1, 0}), {7, 0, 0});
}

TEST(GltfNodes, MatricesAreColumnMajor) {
    const SceneData scene =
        read(with_nodes({{{"mesh", 0}, {"matrix", {0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 5, 6, 7, 1}}}}));
    expect_near(scene.instances.at(0).world_from_object.point({1, 0, 0}), {5, 7, 7});
}

TEST(GltfNodes, ChildrenInheritTransforms) {
    const SceneData scene =
        read(with_nodes({{{"children", {1}}, {"translation", {1, 0, 0}}, {"scale", {2, 2, 2}}},
                         {{"mesh", 0}, {"translation", {0, 1, 0}}}}));
    expect_near(scene.instances.at(0).world_from_object.point({0, 0, 0}), {1, 2, 0});
}

TEST(GltfNodes, DeepHierarchiesDoNotExhaustTheStack) {
    json nodes = json::array();
    constexpr int depth = 50000;
    for (int i = 0; i + 1 < depth; ++i) nodes.push_back({{"children", {i + 1}}});
    nodes.push_back({{"mesh", 0}});
    EXPECT_EQ(read(with_nodes(nodes)).instances.size(), 1u);
}

TEST(GltfNodes, WithoutScenesAllRootsAreShown) {
    GltfBuilder builder = with_nodes({{{"mesh", 0}}, {{"children", {2}}}, {{"mesh", 0}}});
    builder.document.erase("scenes");
    builder.document.erase("scene");
    EXPECT_EQ(read(builder).instances.size(), 2u);
}

TEST(GltfNodes, TheDefaultSceneCountsElseTheFirst) {
    GltfBuilder builder = with_nodes({{{"mesh", 0}}, {{"mesh", 0}}});
    builder.document["scenes"] = {{{"nodes", {0}}}, {{"nodes", {0, 1}}}};
    builder.document["scene"] = 1;
    EXPECT_EQ(read(builder).instances.size(), 2u);
    builder.document.erase("scene");
    EXPECT_EQ(read(builder).instances.size(), 1u);
}

/// Lights that sit on node 1, which looks down: −Z of the node is −Y of the world.
GltfBuilder with_light(const json& light) {
    GltfBuilder builder = with_nodes({{{"mesh", 0}},
                                      {{"translation", {1, 2, 3}},
                                       {"rotation", {-half_root, 0, 0, half_root}},
                                       {"scale", {2, 2, 2}},
                                       {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}}});
    builder.document["scenes"][0]["nodes"] = {0, 1};
    builder.document["extensions"] = {{"KHR_lights_punctual", {{"lights", {light}}}}};
    return builder;
}

TEST(GltfLights, PointLightsStandAtTheirNode) {
    const SceneData scene = read(with_light({{"type", "point"}, {"color", {1, 0.5, 0}}, {"intensity", 10}}));
    ASSERT_EQ(scene.point_lights.size(), 1u);
    EXPECT_EQ(scene.point_lights[0].position, (Vec3{1, 2, 3}));
    EXPECT_EQ(scene.point_lights[0].intensity, (Spectrum{10, 5, 0}));
}

TEST(GltfLights, SpotLightsShineAlongMinusZ) {
    const SceneData scene =
        read(with_light({{"type", "spot"}, {"spot", {{"innerConeAngle", 0.5}, {"outerConeAngle", 1.0}}}}));
    ASSERT_EQ(scene.spot_lights.size(), 1u);
    expect_near(scene.spot_lights[0].direction, {0, -1, 0});
    EXPECT_EQ(scene.spot_lights[0].intensity, Spectrum{1});
    EXPECT_FLOAT_EQ(scene.spot_lights[0].cos_inner, std::cos(0.5f));
    EXPECT_FLOAT_EQ(scene.spot_lights[0].cos_outer, std::cos(1.0f));
}

TEST(GltfLights, SpotLightsHaveDefaultCones) {
    const SceneData scene = read(with_light({{"type", "spot"}, {"spot", json::object()}}));
    EXPECT_EQ(scene.spot_lights.at(0).cos_inner, 1);
    EXPECT_FLOAT_EQ(scene.spot_lights.at(0).cos_outer, 0.70710678f);
}

TEST(GltfLights, DirectionalLightsTravelAlongMinusZ) {
    const SceneData scene = read(with_light({{"type", "directional"}, {"intensity", 3}}));
    ASSERT_EQ(scene.directional_lights.size(), 1u);
    expect_near(scene.directional_lights[0].direction, {0, -1, 0});
    EXPECT_EQ(scene.directional_lights[0].irradiance, Spectrum{3});
}

TEST(GltfCameras, PerspectiveKeepsFieldOfViewAndLosesScale) {
    GltfBuilder builder = with_nodes({{{"mesh", 0}},
                                      {{"name", "eye"},
                                       {"camera", 0},
                                       {"translation", {0, 0, 5}},
                                       {"rotation", {0, half_root, 0, half_root}},  // looks along −X
                                       {"scale", {2, 3, 4}}}});
    builder.document["scenes"][0]["nodes"] = {0, 1};
    builder.add("cameras", {{"type", "perspective"},
                            {"perspective", {{"yfov", 0.5}, {"aspectRatio", 1.5}, {"znear", 0.1}}}});
    const SceneData scene = read(builder);
    ASSERT_EQ(scene.cameras.size(), 1u);
    EXPECT_EQ(scene.cameras[0].name, "eye");
    EXPECT_EQ(scene.cameras[0].vertical_extent, 0.5);
    EXPECT_EQ(scene.cameras[0].aspect, 1.5);
    expect_near(scene.cameras[0].world_from_camera.vector({0, 0, -1}), {-1, 0, 0});
    expect_near(scene.cameras[0].world_from_camera.vector({0, 1, 0}), {0, 1, 0});
    expect_near(scene.cameras[0].world_from_camera.point({0, 0, 0}), {0, 0, 5});
}

TEST(GltfCameras, OrthographicHeightIsTwiceYmag) {
    GltfBuilder builder = with_nodes({{{"mesh", 0}, {"camera", 0}}});
    builder.add("cameras", {{"type", "orthographic"},
                            {"orthographic", {{"xmag", 3}, {"ymag", 2}, {"znear", 0}, {"zfar", 10}}}});
    const SceneData scene = read(builder);
    EXPECT_TRUE(scene.cameras.at(0).orthographic);
    EXPECT_EQ(scene.cameras.at(0).vertical_extent, 4);
    EXPECT_EQ(scene.cameras.at(0).aspect, 1.5);
}

TEST(GltfCameras, NamesComeFromNodeOrCameraOrNumberAndAreUnique) {
    GltfBuilder builder = with_nodes({{{"mesh", 0}, {"children", {1, 2, 3, 4}}},
                                      {{"camera", 0}, {"name", "a"}},
                                      {{"camera", 0}, {"name", "a"}},
                                      {{"camera", 0}},
                                      {{"camera", 1}}});
    const json perspective = {{"yfov", 0.5}, {"znear", 0.1}};
    builder.add("cameras", {{"type", "perspective"}, {"name", "b"}, {"perspective", perspective}});
    builder.add("cameras", {{"type", "perspective"}, {"perspective", perspective}});
    std::vector<std::string> names;
    for (const Camera& camera : read(builder).cameras) names.push_back(camera.name);
    EXPECT_EQ(names, (std::vector<std::string>{"a", "a (2)", "b", "camera 3"}));
}

}  // namespace
}  // namespace relumine
