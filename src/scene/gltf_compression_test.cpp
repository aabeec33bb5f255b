// SPDX-License-Identifier: Apache-2.0
// Compressed meshes: what the packers of Draco and meshoptimizer make comes back, and damage ends in one
// clear line.
#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#include <gtest/gtest.h>
#include <meshoptimizer.h>

#include <functional>

#include "relumine/error.hpp"
#include "relumine/scene.hpp"
#include "scene/readers.hpp"
#include "scene/test_files.hpp"

namespace relumine {
namespace {

using nlohmann::json;
using test::GltfBuilder;
using test::TempFolder;

std::string message_of(const GltfBuilder& builder) {
    const TempFolder folder;
    const std::string path = folder.write("scene.gltf", builder.json_text());
    try {
        (void)load_scene(path);
    } catch (const Error& error) {
        const std::string message = error.what();
        EXPECT_EQ(message.rfind(path, 0), 0u) << message;
        EXPECT_EQ(message.find('\n'), message.npos) << message;
        return message;
    }
    return "";
}

SceneData read(const GltfBuilder& builder) {
    const TempFolder folder;
    return read_gltf(folder.write("scene.gltf", builder.json_text()));
}

/// n × n quads in the plane z = 0, a metre apart: positions and corners.
struct Grid {
    std::vector<float> positions;
    std::vector<std::uint32_t> corners;

    explicit Grid(std::uint32_t n) {
        for (std::uint32_t y = 0; y <= n; ++y)
            for (std::uint32_t x = 0; x <= n; ++x)
                for (const float value : {static_cast<float>(x), static_cast<float>(y), 0.0f})
                    positions.push_back(value);
        for (std::uint32_t y = 0; y < n; ++y)
            for (std::uint32_t x = 0; x < n; ++x) {
                const std::uint32_t a = y * (n + 1) + x, b = a + 1, c = a + n + 1, d = c + 1;
                corners.insert(corners.end(), {a, b, d, a, d, c});
            }
    }
    [[nodiscard]] std::size_t vertices() const { return positions.size() / 3; }
};

/// A document of one mesh whose accessors the caller adds.
GltfBuilder mesh_document(std::size_t positions, std::size_t indices) {
    GltfBuilder builder;
    builder.document = test::triangle_document().document;
    for (const char* name : {"accessors", "bufferViews"}) builder.document.erase(name);
    builder.attributes()["POSITION"] = positions;
    builder.primitive()["indices"] = indices;
    return builder;
}

double area(const SceneData& scene) {
    double sum = 0;
    for (const Mesh& mesh : scene.meshes)
        for (const Triangle& t : mesh.triangles) {
            const Vec3 a = mesh.positions.at(t.vertex[0]), b = mesh.positions.at(t.vertex[1]),
                       c = mesh.positions.at(t.vertex[2]);
            sum += 0.5 * double{length(cross(b - a, c - a))};
        }
    return sum;
}

// ---- EXT_meshopt_compression ----

json packed_view(std::size_t buffer_view_bytes, const json& extension) {
    return {{"buffer", 1},
            {"byteLength", buffer_view_bytes},
            {"extensions", {{"EXT_meshopt_compression", extension}}}};
}

/// The grid with positions and indices packed, over a fallback buffer that is not there.
GltfBuilder meshopt_document(const Grid& grid) {
    GltfBuilder builder = mesh_document(0, 1);
    std::string vertices(meshopt_encodeVertexBufferBound(grid.vertices(), 12), '\0');
    vertices.resize(meshopt_encodeVertexBuffer(reinterpret_cast<unsigned char*>(vertices.data()),
                                               vertices.size(), grid.positions.data(), grid.vertices(), 12));
    std::string corners(meshopt_encodeIndexBufferBound(grid.corners.size(), grid.vertices()), '\0');
    corners.resize(meshopt_encodeIndexBuffer(reinterpret_cast<unsigned char*>(corners.data()), corners.size(),
                                             grid.corners.data(), grid.corners.size()));
    builder.binary = vertices + corners;
    builder.add("bufferViews", packed_view(12 * grid.vertices(), {{"buffer", 0},
                                                                  {"byteLength", vertices.size()},
                                                                  {"byteStride", 12},
                                                                  {"count", grid.vertices()},
                                                                  {"mode", "ATTRIBUTES"}}));
    builder.add("bufferViews", packed_view(4 * grid.corners.size(), {{"buffer", 0},
                                                                     {"byteOffset", vertices.size()},
                                                                     {"byteLength", corners.size()},
                                                                     {"byteStride", 4},
                                                                     {"count", grid.corners.size()},
                                                                     {"mode", "TRIANGLES"}}));
    builder.add("accessors",
                {{"bufferView", 0}, {"componentType", 5126}, {"count", grid.vertices()}, {"type", "VEC3"}});
    builder.add(
        "accessors",
        {{"bufferView", 1}, {"componentType", 5125}, {"count", grid.corners.size()}, {"type", "SCALAR"}});
    builder.document["extensionsRequired"] = {"EXT_meshopt_compression"};
    builder.document["buffers"] = {
        {{"byteLength", builder.binary.size()},
         {"uri", "data:application/octet-stream;base64," + test::base64(builder.binary)}},
        {{"byteLength", 12 * grid.vertices() + 4 * grid.corners.size()},
         {"extensions", {{"EXT_meshopt_compression", {{"fallback", true}}}}}}};
    return builder;
}

TEST(GltfMeshopt, UnpacksPositionsAndIndices) {
    const Grid grid{20};
    const SceneData scene = read(meshopt_document(grid));
    ASSERT_EQ(scene.meshes.size(), 1u);
    ASSERT_EQ(scene.meshes[0].positions.size(), grid.vertices());
    for (std::size_t i = 0; i < grid.vertices(); ++i) {
        const Vec3 p = scene.meshes[0].positions[i];
        EXPECT_EQ(p.x, grid.positions[3 * i]);
        EXPECT_EQ(p.y, grid.positions[3 * i + 1]);
    }
    EXPECT_NEAR(area(scene), 400, 1e-9);
}

struct Damage {
    const char* name;
    const char* pointer;
    json value;
    const char* expected;
};

TEST(GltfMeshopt, DamageEndsInOneClearLine) {
    const std::string view = "/bufferViews/0/extensions/EXT_meshopt_compression";
    const std::vector<Damage> damages{
        {"buffer beyond buffers", "/buffer", 7, "EXT_meshopt_compression.buffer"},
        {"offset behind buffer", "/byteOffset", 1 << 30, "byteOffset: expected at most"},
        {"length behind buffer", "/byteLength", 1 << 30, "byteLength: expected at most"},
        {"stride 0", "/byteStride", 0, "byteStride"},
        {"stride of 6", "/byteStride", 6, "byteStride: expected a multiple of 4, found 6"},
        {"count 0", "/count", 0, "count"},
        {"count too small", "/count", 3, "expected the 5292 bytes of the view"},
        {"count huge", "/count", 2000000000, "expected the 5292 bytes of the view"},
        {"count beyond int", "/count", 1ull << 40, "count"},
        {"mode unknown", "/mode", "ZIP", "mode: expected ATTRIBUTES, TRIANGLES or INDICES, found \"ZIP\""},
        {"indices of 12 bytes", "/mode", "INDICES", "byteStride: expected 2 or 4"},
        {"filter unknown", "/filter", "BLUR", "filter: expected NONE"},
        {"filter of another stride", "/filter", "QUATERNION", "filter: expected NONE"},
        {"mode is a number", "/mode", 1, "mode"},
        {"data cut short", "/byteLength", 40, "what 40 bytes can hold"},
        {"data damaged", "/byteOffset", 3, "damaged data"},
        {"the fallback's bytes", "/buffer", 1, "expected at most 0"},
    };
    for (const Damage& damage : damages) {
        GltfBuilder builder = meshopt_document(Grid{20});
        builder.document[json::json_pointer{view + damage.pointer}] = damage.value;
        const std::string message = message_of(builder);
        EXPECT_NE(message.find(damage.expected), message.npos) << damage.name << ": " << message;
    }
}

TEST(GltfMeshopt, SizesThatTheDataCannotHoldAreRefusedBeforeMemoryIsTaken) {
    GltfBuilder builder = meshopt_document(Grid{20});
    builder.document["bufferViews"][0]["byteLength"] = 12000000000u;
    builder.document["bufferViews"][0]["extensions"]["EXT_meshopt_compression"]["count"] = 1000000000;
    const std::string message = message_of(builder);
    EXPECT_NE(message.find("count: expected at most"), message.npos) << message;
}

TEST(GltfMeshopt, FallbackBuffersHoldNothingForOtherViews) {
    GltfBuilder builder = meshopt_document(Grid{20});
    builder.document["bufferViews"][0].erase("extensions");
    EXPECT_NE(message_of(builder).find("bufferViews[0].byteLength"), std::string::npos);
}

// ---- KHR_draco_mesh_compression ----

/// The grid as Draco packs it; `method`: of draco::MeshEncoderMethod.
std::string draco_bytes(const Grid& grid, int method) {
    draco::TriangleSoupMeshBuilder soup;
    soup.Start(static_cast<int>(grid.corners.size() / 3));
    const int position = soup.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
    for (std::size_t face = 0; face < grid.corners.size() / 3; ++face) {
        const auto corner = [&](std::size_t k) { return &grid.positions[3 * grid.corners[3 * face + k]]; };
        soup.SetAttributeValuesForFace(position, draco::FaceIndex(static_cast<std::uint32_t>(face)),
                                       corner(0), corner(1), corner(2));
    }
    const auto mesh = soup.Finalize();
    draco::Encoder encoder;
    encoder.SetEncodingMethod(method);
    encoder.SetAttributeQuantization(draco::GeometryAttribute::POSITION, 14);
    draco::EncoderBuffer buffer;
    EXPECT_TRUE(encoder.EncodeMeshToBuffer(*mesh, &buffer).ok());
    return {buffer.data(), buffer.size()};
}

GltfBuilder draco_document(const Grid& grid, const std::string& bytes) {
    GltfBuilder builder = mesh_document(0, 1);
    const std::size_t view = builder.add_view(bytes);
    builder.add("accessors", {{"componentType", 5126}, {"count", grid.vertices()}, {"type", "VEC3"}});
    builder.add("accessors", {{"componentType", 5125}, {"count", grid.corners.size()}, {"type", "SCALAR"}});
    builder.primitive()["extensions"] = {
        {"KHR_draco_mesh_compression", {{"bufferView", view}, {"attributes", {{"POSITION", 0}}}}}};
    builder.document["extensionsRequired"] = {"KHR_draco_mesh_compression"};
    return builder;
}

TEST(GltfDraco, UnpacksBothOfItsMethods) {
    const Grid grid{20};
    for (const int method : {draco::MESH_SEQUENTIAL_ENCODING, draco::MESH_EDGEBREAKER_ENCODING}) {
        const SceneData scene = read(draco_document(grid, draco_bytes(grid, method)));
        ASSERT_EQ(scene.meshes.size(), 1u);
        EXPECT_EQ(scene.meshes[0].positions.size(), grid.vertices());
        EXPECT_EQ(scene.meshes[0].triangles.size(), grid.corners.size() / 3);
        EXPECT_NEAR(area(scene), 400, 0.1);  // quantised to 14 bits
    }
}

TEST(GltfDraco, DamageEndsInOneClearLine) {
    const Grid grid{20};
    const std::string bytes = draco_bytes(grid, draco::MESH_SEQUENTIAL_ENCODING);
    const auto with = [&](const std::function<void(std::string&)>& change) {
        std::string changed = bytes;
        change(changed);
        return draco_document(grid, changed);
    };
    struct Case {
        GltfBuilder builder;
        const char* expected;
    };
    const auto set_json = [&](const std::string& pointer, const json& value) {
        GltfBuilder builder = draco_document(grid, bytes);
        builder.document[json::json_pointer{"/meshes/0/primitives/0" + pointer}] = value;
        return builder;
    };
    const std::string extension = "/extensions/KHR_draco_mesh_compression";
    const std::vector<Case> cases{
        {with([](std::string& b) { b[0] = 'X'; }), "expected Draco data"},
        {with([](std::string& b) { b[5] = 1; }), "expected Draco bitstream 2.2"},
        {with([](std::string& b) { b[7] = 0; }), "expected a Draco mesh"},
        {with([](std::string& b) { b[8] = 9; }), "expected a Draco mesh"},
        {with([](std::string& b) { b[10] = '\x80'; }), "without metadata"},
        {with([](std::string& b) { b.resize(11); }), "the end of the data"},
        {with([](std::string& b) { b.resize(b.size() / 2); }), "expected valid Draco data"},
        {with([](std::string& b) { b.replace(11, 2, "\xff\xff\xff\xff\x0f"); }), "points and faces in"},
        {with([](std::string& b) { b.replace(11, 2, "\xff\xff\xff\xff\xff\xff"); }), "the end of the data"},
        {set_json("/mode", 5), "primitives[0].mode: expected 4"},
        {set_json(extension + "/bufferView", 9), "KHR_draco_mesh_compression.bufferView"},
        {set_json(extension + "/attributes/POSITION", 70),
         "the id of an attribute in the Draco data, found 70"},
        {set_json(extension + "/attributes/POSITION", -1), "attributes.\"POSITION\""},
        {set_json(extension + "/attributes/NORMAL", 0), "an attribute of the primitive, found none"},
        {set_json(extension + "/attributes", 3), "KHR_draco_mesh_compression.attributes"},
    };
    for (const auto& [builder, expected] : cases) {
        const std::string message = message_of(builder);
        EXPECT_NE(message.find(expected), message.npos) << expected << ": " << message;
    }
    GltfBuilder other = draco_document(grid, bytes);
    other.document["accessors"][0]["count"] = 7;
    EXPECT_NE(message_of(other).find("7 points in the Draco data"), std::string::npos);
}

TEST(GltfDraco, EveryCutEndsInAnErrorOrAScene) {
    const Grid grid{4};
    for (const int method : {draco::MESH_SEQUENTIAL_ENCODING, draco::MESH_EDGEBREAKER_ENCODING}) {
        const std::string bytes = draco_bytes(grid, method);
        for (std::size_t size = 1; size < bytes.size(); ++size)
            (void)message_of(draco_document(grid, bytes.substr(0, size)));
        for (std::size_t i = 0; i < bytes.size(); ++i) {
            std::string changed = bytes;
            changed[i] = static_cast<char>(changed[i] ^ 0x55);
            (void)message_of(draco_document(grid, changed));
        }
    }
}

}  // namespace
}  // namespace relumine
