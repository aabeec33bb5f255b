// SPDX-License-Identifier: Apache-2.0
// Damaged shells: GLB headers and chunks that lie, text that is no JSON, links that lead out of the folder.
#include <gtest/gtest.h>

#include <filesystem>

#include "relumine/error.hpp"
#include "relumine/scene.hpp"
#include "scene/test_files.hpp"

namespace relumine {
namespace {

using test::GltfBuilder;
using test::TempFolder;

/// Loading these bytes must end in one line that begins with the file and holds `part`.
void expect_refused(const std::string& bytes, const std::string& part) {
    const TempFolder folder;
    const std::string path = folder.write("scene.glb", bytes);
    try {
        (void)load_scene(path);
        ADD_FAILURE() << "was accepted";
    } catch (const Error& error) {
        const std::string message = error.what();
        EXPECT_EQ(message.rfind(path, 0), 0u) << message;
        EXPECT_NE(message.find(part), message.npos) << message;
        EXPECT_EQ(message.find('\n'), message.npos) << message;
    }
}

std::string with_u32(std::string bytes, std::size_t at, std::uint32_t value) {
    std::memcpy(bytes.data() + at, &value, 4);
    return bytes;
}

TEST(GltfContainer, RefusesGlbCutAnywhere) {
    const std::string glb = test::triangle_document().glb();
    for (std::size_t i = 0; i < 16; ++i) expect_refused(glb.substr(0, glb.size() * i / 16), "expected");
}

TEST(GltfContainer, RefusesFilesCutAnywhereWithAnHonestLength) {
    const std::string glb = test::triangle_document().glb();
    for (std::size_t size = 12; size < glb.size(); size += 5)
        expect_refused(with_u32(glb.substr(0, size), 8, static_cast<std::uint32_t>(size)), "expected");
}

TEST(GltfContainer, RefusesLyingHeaders) {
    const std::string glb = test::triangle_document().glb();
    expect_refused(with_u32(glb, 4, 1), "version 1");
    expect_refused(with_u32(glb, 8, 0xffffffff), "GLB length");
    expect_refused(with_u32(glb, 8, 0), "GLB length");
    expect_refused(with_u32(glb, 12, 0xfffffffc), "GLB chunk 0");
    expect_refused(with_u32(glb, 12, 0), "GLB chunk 1");
    expect_refused(with_u32(glb, 16, 0x004e4942), "GLB chunk 0");
    std::uint32_t json_size = 0;
    std::memcpy(&json_size, glb.data() + 12, 4);
    expect_refused(with_u32(glb, 20 + json_size, 0xfffffff0), "GLB chunk 1");
    expect_refused(with_u32(glb, 20 + json_size, 4), "GLB chunk");
    expect_refused(with_u32(glb, 24 + json_size, 1234), "buffers[0].uri");
}

TEST(GltfContainer, RefusesTextThatIsNoScene) {
    expect_refused("", "an empty file");
    expect_refused("glTF", "4 bytes");
    expect_refused("[", ":1:2");
    expect_refused("{\n  \"asset\": }", ":2:12");
    expect_refused("[]", "an object");
    expect_refused("null", "an object");
    expect_refused("{}", "asset");
    expect_refused("\x89PNG\r\n\x1a\n", "valid JSON");
    expect_refused("{\"asset\": {\"version\": \"2.0\xff\"}}", "valid JSON");
    expect_refused("{\"asset\": {\"version\": \"2.0\"}, \"scene\": 1e999}", "valid JSON");
    expect_refused(test::triangle_document().json_text() + "}", "valid JSON");
}

TEST(GltfContainer, RefusesJsonCutAnywhere) {
    const std::string text = test::triangle_document().json_text();
    for (std::size_t i = 0; i < 16; ++i) expect_refused(text.substr(0, text.size() * i / 16), "expected");
}

TEST(GltfContainer, RefusesDeepNesting) {
    expect_refused(std::string(100000, '['), "64 nested values");
    std::string objects;
    for (int i = 0; i < 100000; ++i) objects += "{\"a\":";
    expect_refused(objects, "64 nested values");
    expect_refused("{\"asset\": {\"version\": \"2.0\"}, \"extras\": " + std::string(1000, '[')
                       + std::string(1000, ']') + "}",
                   "64 nested values");
}

TEST(GltfContainer, BracketsInStringsDoNotNest) {
    GltfBuilder builder = test::triangle_document();
    builder.document["meshes"][0]["name"] = std::string(200, '[') + "\\\"" + std::string(200, '{');
    const TempFolder folder;
    EXPECT_EQ(load_scene(folder.write("scene.gltf", builder.json_text())).info().triangles, 1u);
}

TEST(GltfContainer, RefusesLinksThatLeadOutside) {
    const TempFolder folder;
    GltfBuilder builder = test::triangle_document();
    const std::string outside = folder.write("outside.bin", builder.binary);
    builder.document["buffers"] = {{{"byteLength", builder.binary.size()}, {"uri", "link.bin"}}};
    const std::string path = folder.write("scene/scene.gltf", builder.json_text());
    std::filesystem::create_symlink(outside, folder.path("scene/link.bin"));
    try {
        (void)load_scene(path);
        ADD_FAILURE() << "was accepted";
    } catch (const SceneError& error) {
        EXPECT_NE(std::string{error.what()}.find("\"link.bin\", a link that leads outside"),
                  std::string::npos);
    }
}

TEST(GltfContainer, FollowsLinksInsideItsFolder) {
    const TempFolder folder;
    GltfBuilder builder = test::triangle_document();
    folder.write("scene/data/real.bin", builder.binary);
    builder.document["buffers"] = {{{"byteLength", builder.binary.size()}, {"uri", "data/../link.bin"}}};
    const std::string path = folder.write("scene/scene.gltf", builder.json_text());
    std::filesystem::create_symlink("data/real.bin", folder.path("scene/link.bin"));
    EXPECT_EQ(load_scene(path).info().triangles, 1u);
}

TEST(GltfContainer, SurvivesAnyChangedByte) {
    const std::string glb = test::triangle_document().glb();
    const TempFolder folder;
    for (std::size_t at = 0; at < glb.size(); ++at) {
        for (const int flip : {0x01, 0x80, 0xff}) {
            std::string damaged = glb;
            damaged[at] = static_cast<char>(damaged[at] ^ flip);
            try {
                (void)load_scene(folder.write("scene.glb", damaged));
            } catch (const Error& error) {
                EXPECT_EQ(std::string{error.what()}.find('\n'), std::string::npos);
            }
        }
    }
}

}  // namespace
}  // namespace relumine
