// SPDX-License-Identifier: Apache-2.0
// OBJ meshes, sound and damaged.
#include <gtest/gtest.h>

#include "relumine/error.hpp"
#include "scene/readers.hpp"
#include "scene/test_files.hpp"

namespace relumine {
namespace {

using test::TempFolder;

Mesh read(const std::string& text, std::vector<std::string>* warnings = nullptr) {
    const TempFolder folder;
    std::vector<std::string> ignored;
    return read_obj(folder.write("mesh.obj", text), warnings != nullptr ? *warnings : ignored);
}

const std::string corners = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

TEST(ObjReader, ReadsTriangles) {
    const Mesh mesh = read("# comment\no thing\n" + corners + "f 1 2 3\n");
    EXPECT_EQ(mesh.positions, (std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}}));
    ASSERT_EQ(mesh.triangles.size(), 1u);
    EXPECT_TRUE(mesh.normals.empty());
    EXPECT_TRUE(mesh.uvs[0].empty());
}

TEST(ObjReader, CutsPolygonsAndCountsBackwards) {
    const Mesh mesh = read(corners + "f -4 -3 -2 -1\r\ng other\nf 1 2 3\n");
    ASSERT_EQ(mesh.triangles.size(), 3u);
    EXPECT_EQ(mesh.triangles[1].vertex, (std::array<std::uint32_t, 3>{0, 2, 3}));
    EXPECT_EQ(mesh.positions.size(), 4u);
}

TEST(ObjReader, JoinsSeparateIndices) {
    const Mesh mesh = read(
        corners + "vn 0 0 1\nvn 1 0 0\nvt 0.25 0.25\nvt 1 0\nf 1/1/1 2/1/1 3/1/1\nf 1/1/1 3/1/1 4/2/2\n");
    EXPECT_EQ(mesh.positions.size(), 4u);  // vertices 1 and 3 are shared
    EXPECT_EQ(mesh.normals.at(3), (Vec3{1, 0, 0}));
    EXPECT_EQ(mesh.uvs[0].at(0), (Vec2{0.25f, 0.75f}));  // v turned to grow downwards
}

TEST(ObjReader, NormalsOfSomeCornersOnlyAreLeftOut) {
    const Mesh mesh = read(corners + "vn 0 0 1\nf 1//1 2//1 3//1\nf 1 3 4\n");
    EXPECT_TRUE(mesh.normals.empty());
    EXPECT_EQ(mesh.triangles.size(), 2u);
}

TEST(ObjReader, IgnoresMaterialsWithAWarningAndOpensNothing) {
    std::vector<std::string> warnings;
    (void)read("mtllib /etc/passwd\nusemtl a\nmtllib ../b.mtl\nl 1 2\n" + corners + "f 1 2 3\n", &warnings);
    ASSERT_EQ(warnings.size(), 2u);
    EXPECT_NE(warnings[0].find("materials"), std::string::npos);
}

TEST(ObjReader, LeavesOutFacesWithFewerThanThreeCornersWithAWarning) {
    std::vector<std::string> warnings;
    EXPECT_EQ(read(corners + "f 1 2\nf 1 2 3\n", &warnings).triangles.size(), 1u);
    ASSERT_EQ(warnings.size(), 1u);
}

TEST(ObjReader, ReadsNumbersExactly) {
    EXPECT_EQ(read("v 0.1 -2.5e-3 +.5\nv 1 0 0\nv 0 1 0\nf 1 2 3").positions[0],
              (Vec3{0.1f, -2.5e-3f, 0.5f}));
}

TEST(ObjReader, SkipsTheExtensionsThatSizeArrays) {
    EXPECT_EQ(read("t crease 2000000000/0/0 1 2\nvw 0 0 1\n" + corners + "f 1 2 3\n").triangles.size(), 1u);
}

TEST(ObjReader, DamageEndsInOneClearLine) {
    const TempFolder folder;
    std::string big_face = corners + "f";
    for (int i = 0; i < 300; ++i) big_face += " 1";
    for (const std::string& text :
         {corners + "f 1 2 5\n", corners + "f 1 2 0\n", corners + "f 1 2 -9\n",
          corners + "f 1 2 99999999999\n", corners + "f a b c\n", corners + "f 1/7 2/7 3/7\n",
          corners + "f 1//7 2//7 3//7\n", std::string{"f 1 2 3\n"}, std::string{"v 0 nan 0\n"},
          std::string{"v 0 0\n"}, std::string{"v\n"}, std::string{"v inf 0 0\n"}, std::string{"vt\n"},
          std::string{"vn 1 2 x\n"}, big_face}) {
        SCOPED_TRACE(text.substr(0, 80));
        const std::string path = folder.write("mesh.obj", text);
        std::vector<std::string> warnings;
        try {
            (void)read_obj(path, warnings);
            ADD_FAILURE() << "was accepted";
        } catch (const Error& error) {
            EXPECT_EQ(std::string{error.what()}.rfind(path, 0), 0u) << error.what();
            EXPECT_EQ(std::string{error.what()}.find('\n'), std::string::npos) << error.what();
        }
    }
}

}  // namespace
}  // namespace relumine
