// SPDX-License-Identifier: Apache-2.0
// The public way in: load_scene with its options, environments, and SceneBuilder.
#include <gtest/gtest.h>

#include <limits>

#include "relumine/error.hpp"
#include "relumine/scene.hpp"
#include "scene/readers.hpp"
#include "scene/scene_data.hpp"
#include "scene/test_files.hpp"

namespace relumine {
namespace {

using test::TempFolder;

constexpr float nan = std::numeric_limits<float>::quiet_NaN();

/// A little-endian PFM, which stores its bottom row first.
std::string pfm(int width, int height, const std::vector<float>& rgb) {
    return "PF\n" + std::to_string(width) + ' ' + std::to_string(height) + "\n-1\n" + test::bytes_of(rgb);
}

std::string write_triangle(const TempFolder& folder) {
    return folder.write("scene.gltf", test::triangle_document().json_text());
}

const std::string ply_text =
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement "
    "face 1\n"
    "property list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";

TEST(LoadScene, ChoosesTheReaderByExtension) {
    const TempFolder folder;
    EXPECT_EQ(load_scene(write_triangle(folder)).info().triangles, 1u);
    EXPECT_EQ(load_scene(folder.write("MODEL.PLY", ply_text)).info().triangles, 3u);  // and two of the ground
    EXPECT_EQ(load_scene(folder.write("model.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")).info().triangles,
              3u);
}

TEST(LoadScene, NamesTheExtensionsThatItKnows) {
    try {
        (void)load_scene("scene.fbx");
        FAIL();
    } catch (const SceneError& error) {
        EXPECT_NE(std::string{error.what()}.find(".gltf, .glb, .pbrt, .pbrt.gz, .xml, .ply"),
                  std::string::npos);
    }
}

TEST(LoadScene, RefusesMissingFilesAndFolders) {
    const TempFolder folder;
    EXPECT_THROW((void)load_scene(folder.path("missing.glb")), FileError);
    EXPECT_THROW((void)load_scene(folder.path("missing.ply")), FileError);
    folder.write("folder.glb/file", "");
    EXPECT_THROW((void)load_scene(folder.path("folder.glb")), FileError);
}

TEST(LoadScene, TellsWhatTheSceneHolds) {
    const TempFolder folder;
    auto builder = test::triangle_document();
    builder.add("materials",
                {{"emissiveFactor", {1, 1, 1}}, {"emissiveTexture", {{"index", add_texture(builder)}}}});
    builder.primitive()["material"] = 0;
    builder.add("nodes", {{"mesh", 0}, {"translation", {0, 0, 2}}});
    builder.document["scenes"][0]["nodes"] = {0, 1};
    const SceneInfo info = load_scene(folder.write("scene.gltf", builder.json_text())).info();
    EXPECT_EQ(info.meshes, 1u);
    EXPECT_EQ(info.instances, 2u);
    EXPECT_EQ(info.triangles, 1u);
    EXPECT_EQ(info.instanced_triangles, 2u);
    EXPECT_EQ(info.emissive_triangles, 2u);
    EXPECT_EQ(info.materials, 1u);
    EXPECT_EQ(info.textures, 1u);
    EXPECT_EQ(info.cameras, std::vector<std::string>{"framing"});
    EXPECT_EQ(info.bounds_max, (std::array<float, 3>{1, 1, 2}));
    EXPECT_GT(info.memory_bytes, 36u);
    EXPECT_FALSE(info.has_environment);
    EXPECT_TRUE(info.warnings.empty());
}

TEST(LoadScene, EnvironmentIsReadScaledAndTurned) {
    const TempFolder folder;
    const std::string environment = folder.write("sky.pfm", pfm(2, 1, {1, 2, 3, 4, 5, 6}));
    const Scene scene = load_scene(write_triangle(folder), {environment, 2, 450});
    ASSERT_TRUE(scene.data().environment.has_value());
    EXPECT_EQ(scene.data().environment->radiance, (std::vector<Spectrum>{{2, 4, 6}, {8, 10, 12}}));
    EXPECT_NEAR(scene.data().environment->rotation, pi / 2, 1e-6);
    EXPECT_TRUE(scene.info().warnings.empty());
}

TEST(LoadScene, EnvironmentReplacesTheBuiltInSky) {
    const TempFolder folder;
    const std::string environment = folder.write("sky.pfm", pfm(2, 1, std::vector<float>(6, 1)));
    const std::string model = folder.write("model.ply", ply_text);
    EXPECT_EQ(load_scene(model, {environment}).data().environment->width, 2);
    EXPECT_EQ(load_scene(model).data().environment->width, 256);
}

TEST(LoadScene, RefusesBadOptions) {
    const TempFolder folder;
    const std::string path = write_triangle(folder);
    EXPECT_THROW((void)load_scene(path, {"", -1, 0}), SettingsError);
    EXPECT_THROW((void)load_scene(path, {"", nan, 0}), SettingsError);
    EXPECT_THROW((void)load_scene(path, {"", 1, nan}), SettingsError);
    EXPECT_THROW((void)load_scene(path, {folder.path("missing.exr"), 1, 0}), FileError);
}

TEST(ReadEnvironment, DamagedTexelsBecomeBlackWithOneWarning) {
    const TempFolder folder;
    std::vector<std::string> warnings;
    const Environment environment =
        read_environment(folder.write("sky.pfm", pfm(2, 1, {-1, 2, 3, nan, 5, 6})), warnings);
    EXPECT_EQ(environment.radiance, (std::vector<Spectrum>{{0, 2, 3}, {0, 5, 6}}));
    ASSERT_EQ(warnings.size(), 1u);
    EXPECT_NE(warnings[0].find("2 texels"), std::string::npos);
}

TEST(ReadEnvironment, WarnsOfUnusualShapesAndRefusesSinglePixels) {
    const TempFolder folder;
    std::vector<std::string> warnings;
    (void)read_environment(folder.write("square.pfm", pfm(2, 2, std::vector<float>(12, 1))), warnings);
    EXPECT_EQ(warnings.size(), 1u);
    EXPECT_THROW((void)read_environment(folder.write("one.pfm", pfm(1, 1, {1, 1, 1})), warnings), ImageError);
}

/// A builder with one white triangle.
SceneBuilder triangle_builder() {
    static const std::array<std::array<float, 3>, 3> positions{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}};
    static const std::array<std::array<std::uint32_t, 3>, 1> triangles{{{0, 1, 2}}};
    SceneBuilder builder;
    MeshDescription mesh;
    mesh.positions = positions;
    mesh.triangles = triangles;
    mesh.material = builder.add_material({});
    builder.add_instance(builder.add_mesh(mesh));
    return builder;
}

TEST(SceneBuilder, BuildsAScene) {
    SceneBuilder builder = triangle_builder();
    builder.add_light(PointLightDescription{{0, 0, 1}, {1, 2, 3}});
    builder.add_light(DirectionalLightDescription{{0, -2, 0}, {1, 1, 1}});
    builder.add_camera({.name = "front", .vertical_fov = 0.5});
    builder.add_camera({.name = "", .orthographic_height = 3});
    builder.set_environment(2, 1, std::vector<float>{1, 2, 3, 4, 5, 6});
    const Scene scene = builder.build();
    const SceneInfo info = scene.info();
    EXPECT_EQ(info.triangles, 1u);
    EXPECT_EQ(info.cameras, (std::vector<std::string>{"front", "camera 1"}));
    EXPECT_EQ(info.point_lights, 1u);
    EXPECT_TRUE(info.warnings.empty());
    EXPECT_EQ(scene.data().directional_lights[0].direction, (Vec3{0, -1, 0}));
    EXPECT_EQ(scene.data().environment->radiance[1], (Spectrum{4, 5, 6}));
    EXPECT_TRUE(scene.data().cameras[1].orthographic);
    EXPECT_EQ(scene.data().cameras[1].vertical_extent, 3);
}

TEST(SceneBuilder, IsEmptyAfterwards) {
    SceneBuilder builder = triangle_builder();
    (void)builder.build();
    EXPECT_THROW((void)builder.build(), SceneError);
}

TEST(SceneBuilder, RefusesInvalidDescriptions) {
    const auto refused = [](const auto& change) {
        SceneBuilder builder = triangle_builder();
        change(builder);
        EXPECT_THROW((void)builder.build(), SceneError);
    };
    refused([](SceneBuilder& b) { b.add_instance(7); });
    refused([](SceneBuilder& b) { b.add_instance(std::size_t{1} << 32); });
    refused([](SceneBuilder& b) { b.add_material({.name = "rough", .roughness = 2}); });
    refused([](SceneBuilder& b) { b.add_light(PointLightDescription{{nan, 0, 0}, {}}); });
    refused([](SceneBuilder& b) { b.add_light(DirectionalLightDescription{{0, 0, 0}, {1, 1, 1}}); });
    refused([](SceneBuilder& b) { b.add_camera({.name = "wide", .vertical_fov = 4}); });
    refused([](SceneBuilder& b) { b.set_environment(2, 1, std::vector<float>(7)); });
    refused([](SceneBuilder& b) { b.set_environment(-2, -1, std::vector<float>(6)); });
}

}  // namespace
}  // namespace relumine
