// SPDX-License-Identifier: Apache-2.0
// PLY meshes, sound and damaged.
#include <gtest/gtest.h>
#include <zlib.h>

#include <algorithm>

#include "relumine/error.hpp"
#include "scene/finish_scene.hpp"
#include "scene/readers.hpp"
#include "scene/test_files.hpp"

namespace relumine {
namespace {

using test::TempFolder;

const std::string triangle_header =
    "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
    "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
const std::string triangle_text =
    "ply\nformat ascii 1.0\n" + triangle_header + "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";

Mesh read(const std::string& bytes, std::vector<std::string>* warnings = nullptr) {
    const TempFolder folder;
    std::vector<std::string> ignored;
    return read_ply(folder.write("mesh.ply", bytes), warnings != nullptr ? *warnings : ignored);
}

void expect_unit_triangle(const Mesh& mesh) {
    EXPECT_EQ(mesh.positions, (std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
    ASSERT_EQ(mesh.triangles.size(), 1u);
    EXPECT_EQ(mesh.triangles[0].vertex, (std::array<std::uint32_t, 3>{0, 1, 2}));
}

template <typename T>
std::string big_endian(const std::vector<T>& values) {
    std::string bytes;
    for (const T value : values) {
        std::string one = test::bytes_of(std::vector<T>{value});
        std::ranges::reverse(one);
        bytes += one;
    }
    return bytes;
}

std::string gzip(const std::string& text) {
    std::string packed(text.size() + 100, '\0');
    z_stream stream{};
    deflateInit2(&stream, 6, Z_DEFLATED, 15 + 16, 8, Z_DEFAULT_STRATEGY);
    std::string input = text;
    stream.next_in = reinterpret_cast<Bytef*>(input.data());
    stream.avail_in = static_cast<uInt>(input.size());
    stream.next_out = reinterpret_cast<Bytef*>(packed.data());
    stream.avail_out = static_cast<uInt>(packed.size());
    deflate(&stream, Z_FINISH);
    packed.resize(stream.total_out);
    deflateEnd(&stream);
    return packed;
}

TEST(PlyReader, ReadsText) { expect_unit_triangle(read(triangle_text)); }

TEST(PlyReader, ReadsTextWithCarriageReturns) {
    std::string text;
    for (const char c : triangle_text) text += c == '\n' ? std::string{"\r\n"} : std::string{c};
    expect_unit_triangle(read(text));
}

TEST(PlyReader, ReadsPackedFiles) { expect_unit_triangle(read(gzip(triangle_text))); }

TEST(PlyReader, ReadsBothByteOrders) {
    const std::vector<float> positions{0, 0, 0, 1, 0, 0, 0, 1, 0};
    const std::vector<std::int32_t> corners{0, 1, 2};
    expect_unit_triangle(read("ply\nformat binary_little_endian 1.0\n" + triangle_header
                              + test::bytes_of(positions) + '\3' + test::bytes_of(corners)));
    expect_unit_triangle(read("ply\nformat binary_big_endian 1.0\n" + triangle_header + big_endian(positions)
                              + '\3' + big_endian(corners)));
}

TEST(PlyReader, ReadsPropertiesInAnyOrderAndSkipsTheRest) {
    const Mesh mesh = read(
        "ply\nformat ascii 1.0\ncomment made by hand\nobj_info none\n"
        "element camera 1\nproperty list uchar float junk\nproperty int more\n"
        "element face 1\nproperty uchar flags\nproperty list uchar uint vertex_index\nproperty list int "
        "float texcoord\n"
        "element vertex 3\nproperty uchar blue\nproperty double z\nproperty short x\nproperty float "
        "confidence\n"
        "property uchar red\nproperty int y\nproperty uchar green\nproperty float nz\nproperty float nx\n"
        "property float ny\nproperty float t\nproperty float s\nelement empty 7\nend_header\n"
        "2 1.5 2.5 9\n5 3 0 1 2 0\n"
        "255 0 0 0.5 0 0 0 1 0 0 0.25 0.75\n0 0 1 .5 255 0 0 1 0 0 1 1\n0 0 0 +.5 0 1 128 1 0 0 0 0\n");
    expect_unit_triangle(mesh);
    EXPECT_EQ(mesh.normals, std::vector<Vec3>(3, Vec3{0, 0, 1}));
    EXPECT_EQ(mesh.uvs[0][0], (Vec2{0.75f, 0.75f}));  // v turned to grow downwards
    EXPECT_EQ(mesh.colors[0], (std::array<float, 4>{0, 0, 1, 1}));
    EXPECT_NEAR(mesh.colors[2][1], 0.2158605f, 1e-6);  // sRGB 128
}

TEST(PlyReader, FloatColorsAreLinear) {
    const Mesh mesh = read(
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float "
        "z\nproperty float red\n"
        "property float green\nproperty float blue\nproperty float alpha\nelement face 1\n"
        "property list uchar int vertex_indices\nend_header\n0 0 0 .5 .25 1 .125\n1 0 0 0 0 0 1\n0 1 0 0 0 0 "
        "1\n3 0 1 2\n");
    EXPECT_EQ(mesh.colors[0], (std::array<float, 4>{0.5f, 0.25f, 1, 0.125f}));
}

TEST(PlyReader, CutsPolygonsIntoFansAndLeavesOutSmallerFaces) {
    std::vector<std::string> warnings;
    const Mesh mesh = read(
        "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float "
        "z\nelement face 3\n"
        "property list uchar int vertex_indices\nend_header\n0 0 0 1 0 0 1 1 0 0 1 0 0 2 0\n5 0 1 2 3 4\n2 0 "
        "1\n0\n",
        &warnings);
    ASSERT_EQ(mesh.triangles.size(), 3u);
    EXPECT_EQ(mesh.triangles[2].vertex, (std::array<std::uint32_t, 3>{0, 3, 4}));
    ASSERT_EQ(warnings.size(), 1u);
    EXPECT_EQ(warnings[0], "2 faces with fewer than three corners were left out");
}

struct PlyDamage {
    const char* name;
    std::string bytes;
    const char* part;  // of the message
};

std::string replaced(const std::string& from, const std::string& to) {
    std::string text = triangle_text;
    text.replace(text.find(from), from.size(), to);
    return text;
}

std::vector<PlyDamage> ply_damages() {
    const std::string binary = "ply\nformat binary_little_endian 1.0\n" + triangle_header;
    const std::string positions = test::bytes_of(std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0});
    const std::string signed_lists =
        "ply\nformat binary_little_endian 1.0\nelement vertex 0\nproperty float x\nproperty float "
        "y\nproperty float z\n"
        "element face 1\nproperty list int int vertex_indices\nend_header\n";
    return {
        {"Empty", "", "PLY header"},
        {"OnlyMagic", "ply", "PLY header"},
        {"NoMagic", "plyx\n", "\"ply\""},
        {"NoEnd", triangle_text.substr(0, 60), "PLY header"},
        {"UnknownFormat", replaced("ascii", "morse"), ":2"},
        {"UnknownVersion", replaced("1.0", "2.0"), ":2"},
        {"UnknownKeyword", replaced("element face", "elephant face"), "\"elephant\""},
        {"UnknownType", replaced("float x", "quad x"), "\"quad\""},
        {"ShortElement", replaced("element vertex 3", "element vertex"), ":3"},
        {"NegativeCount", replaced("vertex 3", "vertex -3"), "\"-3\""},
        {"CountOfText", replaced("vertex 3", "vertex many"), "\"many\""},
        {"CountOverflows", replaced("vertex 3", "vertex 99999999999999999999999"), ":3"},
        {"CountLies", replaced("vertex 3", "vertex 4000000000"), "element \"vertex\""},
        {"CountLiesHugely", replaced("face 1", "face 18446744073709551615"), "element \"face\""},
        {"BinaryCountLies",
         "ply\nformat binary_little_endian 1.0\nelement vertex 1000000000\nproperty float x\nproperty float "
         "y\n"
         "property float z\nend_header\n1234",
         "element \"vertex\""},
        {"PropertyFirst", "ply\nformat ascii 1.0\nproperty float x\nend_header\n", "an element before"},
        {"FloatListLength", replaced("list uchar int", "list float int"), "integer type"},
        {"NoPosition", replaced("float y", "float why"), "x, y and z"},
        {"NoCorners", replaced("vertex_indices", "something"), "vertex_indices"},
        {"ListWithoutType", replaced("list uchar int vertex_indices", "list uchar vertex_indices"),
         "property list"},
        {"CutShort", triangle_text.substr(0, triangle_text.size() - 4), "found 3"},
        {"CutAfterHeader", triangle_text.substr(0, triangle_text.size() - 20), "element"},
        {"TextForNumber", replaced("1 0 0", "1 zero 0"), "\"zero\""},
        {"FractionForIndex", replaced("3 0 1 2", "3 0 1.5 2"), "\"1.5\""},
        {"IndexTooLarge", replaced("3 0 1 2", "3 0 1 3"), "triangle 0"},
        {"IndexNegative", replaced("3 0 1 2", "3 0 1 -2"), "-2"},
        {"ListTooLong", replaced("3 0 1 2", "200 0 1 2"), "found 200"},
        {"BinaryCut", binary + positions.substr(0, 20), "element"},
        {"BinaryFaceCut", binary + positions + "\3" + std::string(8, '\0'), "a list"},
        {"BinaryListTooLong", binary + positions + "\xff" + std::string(12, '\0'), "found 255"},
        {"NegativeListLength", signed_lists + "\xff\xff\xff\xff" + std::string(12, '\0'), "found -1"},
        {"HugeListLength", signed_lists + "\xff\xff\xff\x7f" + std::string(12, '\0'), "found 2147483647"},
        {"IndexBeyondNoVertices", signed_lists + std::string{"\3\0\0\0", 4} + std::string(12, '\0'),
         "vertices below 0"},
        {"Strips",
         replaced("element face 1\nproperty list uchar int vertex_indices",
                  "element tristrips 1\nproperty list uchar int vertex_indices"),
         "triangle strips"},
        {"DamagedGzip", gzip(triangle_text).substr(0, 60), "gzip"},
    };
}

TEST(PlyReader, DamageEndsInOneClearLine) {
    const TempFolder folder;
    for (const PlyDamage& damage : ply_damages()) {
        SCOPED_TRACE(damage.name);
        const std::string path = folder.write("mesh.ply", damage.bytes);
        std::vector<std::string> warnings;
        try {
            (void)read_ply(path, warnings);
            ADD_FAILURE() << "was accepted";
        } catch (const Error& error) {
            const std::string message = error.what();
            EXPECT_EQ(message.rfind(path, 0), 0u) << message;
            EXPECT_NE(message.find(damage.part), message.npos) << message;
            EXPECT_EQ(message.find('\n'), message.npos) << message;
        }
    }
}

TEST(PlyReader, NonFinitePositionsAreRefusedByTheScene) {
    for (const char* value : {"nan", "inf", "-inf", "1e30"})
        EXPECT_THROW((void)finish_scene(stage_model(read(replaced("1 0 0", "1 0 " + std::string{value})))),
                     SceneError);
}

TEST(PlyReader, SurvivesAnyChangedByte) {
    for (std::size_t at = 0; at < triangle_text.size(); ++at) {
        for (const int flip : {0x01, 0x10, 0xff}) {
            std::string damaged = triangle_text;
            damaged[at] = static_cast<char>(damaged[at] ^ flip);
            try {
                (void)finish_scene(stage_model(read(damaged)));
            } catch (const Error& error) {
                EXPECT_EQ(std::string{error.what()}.find('\n'), std::string::npos);
            }
        }
    }
}

}  // namespace
}  // namespace relumine
