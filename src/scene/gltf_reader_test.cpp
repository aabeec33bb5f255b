// SPDX-License-Identifier: Apache-2.0
// Geometry from glTF: containers, accessors, primitive modes, vertex attributes.
#include <gtest/gtest.h>

#include "relumine/error.hpp"
#include "scene/finish_scene.hpp"
#include "scene/readers.hpp"
#include "scene/test_files.hpp"

namespace relumine {
namespace {

using test::GltfBuilder;
using test::TempFolder;
using test::triangle_document;

SceneData read(const GltfBuilder& builder) {
    const TempFolder folder;
    return read_gltf(folder.write("scene.gltf", builder.json_text()));
}

void expect_unit_triangle(const SceneData& scene) {
    ASSERT_EQ(scene.meshes.size(), 1u);
    const Mesh& mesh = scene.meshes[0];
    ASSERT_EQ(mesh.triangles.size(), 1u);
    EXPECT_EQ(mesh.positions, (std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
    EXPECT_EQ(mesh.triangles[0].vertex, (std::array<std::uint32_t, 3>{0, 1, 2}));
}

bool has_warning(const SceneData& scene, const std::string& part) {
    return std::ranges::any_of(scene.warnings, [&](const std::string& w) { return w.find(part) != w.npos; });
}

TEST(GltfReader, ReadsDataUri) { expect_unit_triangle(read(triangle_document())); }

TEST(GltfReader, ReadsGlbWhateverItsName) {
    const TempFolder folder;
    expect_unit_triangle(read_gltf(folder.write("scene.gltf", triangle_document().glb())));
}

TEST(GltfReader, ReadsGlbWithUnknownChunk) {
    const TempFolder folder;
    std::string glb = triangle_document().glb() + std::string{"\4\0\0\0XXXX1234", 12};
    const auto length = static_cast<std::uint32_t>(glb.size());
    std::memcpy(glb.data() + 8, &length, 4);
    expect_unit_triangle(read_gltf(folder.write("scene.glb", glb)));
}

TEST(GltfReader, ReadsFilesInItsFolderByEncodedName) {
    const TempFolder folder;
    GltfBuilder builder = triangle_document();
    builder.document["buffers"] = {{{"byteLength", builder.binary.size()}, {"uri", "parts/my%20data.bin"}}};
    folder.write("parts/my data.bin", builder.binary + "longer than byteLength");
    expect_unit_triangle(read_gltf(folder.write("scene.gltf", builder.json_text())));
}

TEST(GltfReader, MissingIndicesMeanOneAfterTheOther) {
    GltfBuilder builder = triangle_document();
    builder.primitive().erase("indices");
    expect_unit_triangle(read(builder));
}

TEST(GltfReader, ReadsEveryIndexType) {
    for (const int type : {5121, 5123, 5125}) {
        GltfBuilder builder = triangle_document();
        const std::size_t accessor =
            type == 5121   ? builder.add_accessor<std::uint8_t>({0, 1, 2}, type, "SCALAR", 1)
            : type == 5123 ? builder.add_accessor<std::uint16_t>({0, 1, 2}, type, "SCALAR", 1)
                           : builder.add_accessor<std::uint32_t>({0, 1, 2}, type, "SCALAR", 1);
        builder.primitive()["indices"] = accessor;
        expect_unit_triangle(read(builder));
    }
}

TEST(GltfReader, ReadsInterleavedUnalignedData) {
    GltfBuilder builder = triangle_document();
    std::string bytes = "x";  // one byte before the first vertex, eight behind each
    for (const auto& p : std::vector<std::vector<float>>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}})
        bytes += test::bytes_of(p) + "12345678";
    const std::size_t view = builder.add_view(bytes);
    builder.document["bufferViews"][view]["byteStride"] = 20;
    builder.document["accessors"][0]["bufferView"] = view;
    builder.document["accessors"][0]["byteOffset"] = 1;
    expect_unit_triangle(read(builder));
}

TEST(GltfReader, StridedAccessorMayEndWithItsLastElement) {
    GltfBuilder builder = triangle_document();
    std::string bytes = test::bytes_of(std::vector<float>{0, 0, 0, 9, 1, 0, 0, 9, 0, 1, 0});
    const std::size_t view = builder.add_view(bytes);
    builder.document["bufferViews"][view]["byteStride"] = 16;
    builder.document["accessors"][0]["bufferView"] = view;
    expect_unit_triangle(read(builder));
}

TEST(GltfReader, ScalesNormalizedIntegers) {
    GltfBuilder builder = triangle_document();
    const std::size_t colors =
        builder.add_accessor<std::uint8_t>({255, 0, 51, 255, 0, 0, 0, 0, 0, 0, 0, 0}, 5121, "VEC4", 4);
    const std::size_t uvs = builder.add_accessor<std::uint16_t>({65535, 0, 0, 0, 0, 0}, 5123, "VEC2", 2);
    const std::size_t normals =
        builder.add_accessor<std::int8_t>({-128, 127, 0, 0, 0, 127, 0, 0, 127}, 5120, "VEC3", 3);
    for (const std::size_t accessor : {colors, uvs, normals})
        builder.document["accessors"][accessor]["normalized"] = true;
    builder.attributes()["COLOR_0"] = colors;
    builder.attributes()["TEXCOORD_1"] = uvs;
    builder.attributes()["NORMAL"] = normals;
    const SceneData scene = read(builder);
    EXPECT_EQ(scene.meshes[0].colors[0], (std::array<float, 4>{1, 0, 0.2f, 1}));
    EXPECT_EQ(scene.meshes[0].uvs[1][0], (Vec2{1, 0}));
    EXPECT_EQ(scene.meshes[0].normals[0], (Vec3{-1, 1, 0}));
}

TEST(GltfReader, ReadsIntegerPositions) {
    GltfBuilder builder = triangle_document();
    builder.attributes()["POSITION"] =
        builder.add_accessor<std::int16_t>({0, 0, 0, 1, 0, 0, 0, 1, 0}, 5122, "VEC3", 3);
    builder.document["extensionsRequired"] = {"KHR_mesh_quantization"};
    expect_unit_triangle(read(builder));
}

TEST(GltfReader, RgbColorsAreOpaque) {
    GltfBuilder builder = triangle_document();
    builder.attributes()["COLOR_0"] = builder.add_vec3({0.25f, 0.5f, 1, 0, 0, 0, 0, 0, 0});
    EXPECT_EQ(read(builder).meshes[0].colors[0], (std::array<float, 4>{0.25f, 0.5f, 1, 1}));
}

TEST(GltfReader, SparseValuesReplaceDenseOnes) {
    GltfBuilder builder = triangle_document();
    builder.document["accessors"][0]["sparse"] = {
        {"count", 1},
        {"indices", {{"bufferView", builder.add_view(std::string{"\1", 1})}, {"componentType", 5121}}},
        {"values", {{"bufferView", builder.add_view(test::bytes_of(std::vector<float>{7, 8, 9}))}}}};
    EXPECT_EQ(read(builder).meshes[0].positions[1], (Vec3{7, 8, 9}));
}

TEST(GltfReader, SparseWithoutViewStartsFromZeros) {
    GltfBuilder builder = triangle_document();
    builder.document["accessors"][0].erase("bufferView");
    builder.document["accessors"][0]["sparse"] = {
        {"count", 2},
        {"indices", {{"bufferView", builder.add_view(std::string{"\1\2", 2})}, {"componentType", 5121}}},
        {"values", {{"bufferView", builder.add_view(test::bytes_of(std::vector<float>{1, 0, 0, 0, 1, 0}))}}}};
    expect_unit_triangle(read(builder));
}

TEST(GltfReader, StripsTurnEveryOtherTriangle) {
    GltfBuilder builder = triangle_document();
    builder.attributes()["POSITION"] = builder.add_vec3({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 2, 0});
    builder.primitive()["indices"] = builder.add_indices({0, 1, 2, 3, 4});
    builder.primitive()["mode"] = 5;
    const auto triangles = read(builder).meshes[0].triangles;
    ASSERT_EQ(triangles.size(), 3u);
    EXPECT_EQ(triangles[1].vertex, (std::array<std::uint32_t, 3>{1, 3, 2}));
    EXPECT_EQ(triangles[2].vertex, (std::array<std::uint32_t, 3>{2, 3, 4}));
}

TEST(GltfReader, FansShareTheirFirstVertex) {
    GltfBuilder builder = triangle_document();
    builder.attributes()["POSITION"] = builder.add_vec3({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0});
    builder.primitive()["indices"] = builder.add_indices({0, 1, 2, 3});
    builder.primitive()["mode"] = 6;
    const auto triangles = read(builder).meshes[0].triangles;
    ASSERT_EQ(triangles.size(), 2u);
    EXPECT_EQ(triangles[1].vertex, (std::array<std::uint32_t, 3>{2, 3, 0}));
}

TEST(GltfReader, PointsAndLinesAreLeftOutWithAWarning) {
    for (const int mode : {0, 1, 2, 3}) {
        GltfBuilder builder = triangle_document();
        builder.document["meshes"][0]["primitives"].push_back(builder.primitive());
        builder.primitive()["mode"] = mode;
        const SceneData scene = read(builder);
        expect_unit_triangle(scene);
        EXPECT_TRUE(has_warning(scene, "meshes[0].primitives[0] of \"triangle\": points and lines"));
    }
}

TEST(GltfReader, EachPrimitiveBecomesAMeshAndEachNodeAnInstance) {
    GltfBuilder builder = triangle_document();
    builder.document["meshes"][0]["primitives"].push_back(builder.primitive());
    builder.add("nodes", {{"mesh", 0}, {"translation", {5, 0, 0}}});
    builder.document["scenes"][0]["nodes"] = {0, 1};
    const SceneData scene = read(builder);
    EXPECT_EQ(scene.meshes.size(), 2u);
    ASSERT_EQ(scene.instances.size(), 4u);
    EXPECT_EQ(scene.instances[3].mesh, MeshId{1});
    EXPECT_EQ(scene.instances[3].world_from_object.point({0, 0, 0}), (Vec3{5, 0, 0}));
}

TEST(GltfReader, MeshesOutsideTheSceneAreNotRead) {
    GltfBuilder builder = triangle_document();
    builder.document["meshes"].push_back(builder.document["meshes"][0]);
    builder.add("nodes", {{"mesh", 1}});
    EXPECT_EQ(read(builder).meshes.size(), 1u);
}

TEST(GltfReader, UnknownOptionalExtensionsAreNamedOnce) {
    GltfBuilder builder = triangle_document();
    builder.document["extensionsUsed"] = {"EXT_unheard_of", "EXT_unheard_of"};
    const SceneData scene = read(builder);
    ASSERT_EQ(scene.warnings.size(), 1u);
    EXPECT_TRUE(has_warning(scene, "\"EXT_unheard_of\""));
}

TEST(GltfReader, AnimationsSkinsAndMorphTargetsAreNamed) {
    GltfBuilder builder = triangle_document();
    builder.document["animations"] = {{{"name", "walk"}}};
    builder.document["skins"] = {{{"name", "bones"}}};
    builder.primitive()["targets"] = {{{"POSITION", 0}}};
    const SceneData scene = read(builder);
    expect_unit_triangle(scene);
    EXPECT_TRUE(has_warning(scene, "animations[0] \"walk\""));
    EXPECT_TRUE(has_warning(scene, "skins[0] \"bones\""));
    EXPECT_TRUE(has_warning(scene, "meshes[0] \"triangle\": morph targets"));
}

TEST(GltfReader, OffsetsBeyond32BitsAreNotCut) {
    GltfBuilder builder = triangle_document();
    builder.document["accessors"][0]["byteOffset"] = std::uint64_t{1} << 32;
    EXPECT_THROW((void)read(builder), SceneError);
}

TEST(GltfReader, NamesStayOnOneLine) {
    GltfBuilder builder = triangle_document();
    builder.document["meshes"][0]["name"] = "two\nlines";
    builder.primitive()["mode"] = 0;
    for (const std::string& warning : read(builder).warnings) EXPECT_EQ(warning.find('\n'), warning.npos);
}

}  // namespace
}  // namespace relumine
