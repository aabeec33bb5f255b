// SPDX-License-Identifier: Apache-2.0
// Files that are broken or hostile: each costs one clear line and exit code 1, and what stood under the
// output's name stays.
#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "run_command.hpp"
#include "tiny_scene.hpp"

namespace relumine::test {
namespace {

using nlohmann::json;

constexpr float not_a_number = std::numeric_limits<float>::quiet_NaN();

std::size_t file_count(const ScratchFolder& folder) {
    const std::filesystem::directory_iterator files(folder.path());
    return static_cast<std::size_t>(std::distance(begin(files), end(files)));
}

/// Renders small and fast over an existing picture.
CommandResult render_over_old_picture(const ScratchFolder& folder,
                                      const std::vector<std::string>& scene_and_options) {
    write_bytes(folder / "out.png", "old picture");
    std::vector<std::string> arguments{"render", "-o", folder / "out.png", "--size", "8x8", "--spp", "1"};
    arguments.insert(arguments.end(), scene_and_options.begin(), scene_and_options.end());
    return run_relumine(arguments);
}

/// Expects exit code 1, one line that holds all of `words`, and the old picture alone.
void expect_refusal(const CommandResult& result, const ScratchFolder& folder,
                    const std::vector<std::string>& words, std::size_t files_before) {
    EXPECT_EQ(result.exit_code, 1) << result.err;
    EXPECT_EQ(result.out, "");
    EXPECT_EQ(line_count(result.err), 1u) << result.err;
    EXPECT_EQ(result.err.rfind("relumine render: ", 0), 0u) << result.err;
    for (const std::string& word : words)
        EXPECT_NE(result.err.find(word), std::string::npos) << word << "\n" << result.err;
    EXPECT_EQ(read_bytes(folder / "out.png"), "old picture");
    EXPECT_EQ(file_count(folder), files_before + 1) << "a half-written file stayed behind";
}

// ---- glTF documents with one thing spoilt

struct SpoiltScene {
    std::string name;
    std::function<void(json&)> spoil;
    std::vector<std::string> words;  // of the message: where, and what was expected or found
};

void PrintTo(const SpoiltScene& scene, std::ostream* out) { *out << scene.name; }

const std::vector<SpoiltScene> spoilt_scenes{
    {"NoAsset", [](json& g) { g.erase("asset"); }, {"asset"}},
    {"VersionOfTheFuture", [](json& g) { g["asset"]["version"] = "3.0"; }, {"asset.version", "2.0", "3.0"}},
    {"RequiredExtension",
     [](json& g) { g["extensionsRequired"] = {"EXT_from_nowhere"}; },
     {"EXT_from_nowhere"}},
    {"MeshOutOfRange", [](json& g) { g["nodes"][0]["mesh"] = 7; }, {"nodes[0].mesh", "7"}},
    {"NegativeMesh", [](json& g) { g["nodes"][0]["mesh"] = -1; }, {"nodes[0].mesh", "-1"}},
    {"MaterialOutOfRange",
     [](json& g) { g["meshes"][0]["primitives"][0]["material"] = 5; },
     {"material", "5"}},
    {"AccessorOutOfRange", [](json& g) { g["meshes"][0]["primitives"][0]["indices"] = 9; }, {"indices", "9"}},
    {"ChildOutOfRange", [](json& g) { g["nodes"][0]["children"] = {12}; }, {"nodes[0].children", "12"}},
    {"CyclicNodes",
     [](json& g) {
         g["nodes"][0]["children"] = {1};
         g["nodes"][1]["children"] = {0};
     },
     {"nodes["}},
    {"NodeIsItsOwnChild", [](json& g) { g["nodes"][0]["children"] = {0}; }, {"nodes["}},
    {"VertexOutOfRange",
     [](json& g) {
         set_geometry(g, {.indices = {0, 1, 2, 0, 2, 4}});
     },
     {"triangle 1", "4"}},
    {"PositionNotANumber",
     [](json& g) {
         set_geometry(g, {.positions = {not_a_number, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0}});
     },
     {"finite"}},
    {"TranslationOverflows",
     [](json& g) {
         g["nodes"][0]["translation"] = {1e300, 0, 0};
     },
     {"nodes[0]"}},
    {"AccessorOverflows",
     [](json& g) { g["accessors"][0]["count"] = 4611686018427387905; },
     {"accessors[0]"}},
    {"AccessorPastItsView", [](json& g) { g["accessors"][0]["count"] = 5; }, {"accessors[0]"}},
    {"AccessorOffsetPastItsView",
     [](json& g) { g["accessors"][1]["byteOffset"] = 4294967290; },
     {"accessors[1]"}},
    {"IndicesAreFloats", [](json& g) { g["accessors"][1]["componentType"] = 5126; }, {"accessors[1]"}},
    {"UnknownComponentType",
     [](json& g) { g["accessors"][0]["componentType"] = 77; },
     {"componentType", "77"}},
    {"ViewPastItsBuffer", [](json& g) { g["bufferViews"][1]["byteLength"] = 4096; }, {"bufferViews[1]"}},
    {"ViewOffsetOverflows",
     [](json& g) { g["bufferViews"][1]["byteOffset"] = 18446744073709551615ull; },
     {"bufferViews[1]"}},
    {"BufferShorterThanPromised",
     [](json& g) { g["buffers"][0]["byteLength"] = 1099511627776; },
     {"buffers[0]"}},
    {"BadBase64", [](json& g) { g["buffers"][0]["uri"] = "data:;base64,AAA*"; }, {"buffers[0]", "base64"}},
    {"MissingBufferFile", [](json& g) { g["buffers"][0]["uri"] = "missing.bin"; }, {"missing.bin"}},
    {"PathTraversal", [](json& g) { g["buffers"][0]["uri"] = "../../../../etc/passwd"; }, {"passwd"}},
    {"EscapedPathTraversal",
     [](json& g) { g["buffers"][0]["uri"] = "%2e%2e/%2e%2e/etc/passwd"; },
     {"passwd"}},
    {"AbsolutePath", [](json& g) { g["buffers"][0]["uri"] = "/etc/passwd"; }, {"/etc/passwd"}},
    {"RemoteBuffer", [](json& g) { g["buffers"][0]["uri"] = "https://example.org/a.bin"; }, {"example.org"}},
    {"CameraSeesNothing", [](json& g) { g["cameras"][0]["perspective"]["yfov"] = 0; }, {"yfov"}},
    {"NegativeEmission",
     [](json& g) {
         g["materials"][0]["emissiveFactor"] = {-1, 0, 0};
     },
     {"material 0", "-1"}},
    {"TextIsNotANumber",
     [](json& g) {
         g["materials"][0]["emissiveFactor"] = {"a", 0, 0};
     },
     {"emissiveFactor"}},
    {"TextureOutOfRange",
     [](json& g) { g["materials"][0]["emissiveTexture"]["index"] = 3; },
     {"emissiveTexture", "3"}},
    {"DamagedTexture",
     [](json& g) {
         g["images"] = {{{"uri", data_uri("\x89PNG\r\n\x1a\n and no more")}}};
         g["textures"] = {{{"source", 0}}};
         g["materials"][0]["emissiveTexture"]["index"] = 0;
     },
     {"images[0]"}},
    {"HugeTexture",
     [](json& g) {
         const std::string header(
             "\x89PNG\r\n\x1a\n\0\0\0\rIHDR\x7f\xff\xff\xff\x7f\xff\xff\xff\x08\x06\0\0\0\x9b\xa3\x6d\x3a",
             33);
         g["images"] = {{{"uri", data_uri(header)}}};
         g["textures"] = {{{"source", 0}}};
         g["materials"][0]["emissiveTexture"]["index"] = 0;
     },
     {"images[0]"}},
    {"EmptyScene",
     [](json& g) {
         g = {{"asset", {{"version", "2.0"}}}};
     },
     {"triangle"}},
    {"DeepNesting",
     [](json& g) {
         for (int i = 0; i < 100; ++i) g["extras"] = json::array({g["extras"]});
     },
     {"nested"}},
};

class SpoiltSceneIs : public testing::TestWithParam<SpoiltScene> {};

TEST_P(SpoiltSceneIs, RefusedInOneLine) {
    const ScratchFolder folder;
    json gltf = tiny_gltf();
    GetParam().spoil(gltf);
    write_bytes(folder / "scene.gltf", gltf.dump());
    const CommandResult result = render_over_old_picture(folder, {folder / "scene.gltf"});
    std::vector<std::string> words = GetParam().words;
    words.push_back("scene.gltf");
    expect_refusal(result, folder, words, 1);
}

INSTANTIATE_TEST_SUITE_P(Cli, SpoiltSceneIs, testing::ValuesIn(spoilt_scenes),
                         [](const auto& spoilt) { return spoilt.param.name; });

// ---- whole files that are not what their names say

struct BadFile {
    std::string name;
    std::string file;
    std::function<std::string()> bytes;
    std::vector<std::string> words = {};
};

void PrintTo(const BadFile& bad, std::ostream* out) { *out << bad.name; }

std::string half(const std::string& bytes) { return bytes.substr(0, bytes.size() / 2); }

std::string ply(const std::string& vertices, const std::string& faces) {
    return "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float "
           "z\nelement face 1\n"
           "property list uchar int vertex_indices\nend_header\n"
           + vertices + faces;
}
constexpr const char* three_vertices = "0 0 0\n1 0 0\n0 1 0\n";

const std::vector<BadFile> bad_scene_files{
    {"EmptyGltf", "a.gltf", [] { return ""; }},
    {"NotJson", "a.gltf", [] { return "<html>"; }, {":1:1"}},
    {"TruncatedGltf", "a.gltf", [] { return half(tiny_gltf().dump()); }, {"JSON"}},
    {"EmptyGlb", "a.glb", [] { return ""; }},
    {"TruncatedGlb", "a.glb", [] { return half(glb_of(tiny_gltf())); }, {"length"}},
    {"GlbHeaderAlone", "a.glb", [] { return glb_of(tiny_gltf()).substr(0, 12); }, {"12 bytes"}},
    {"GlbChunkTooLong",
     "a.glb",
     [] {
         std::string glb = glb_of(tiny_gltf());
         glb[15] = '\x7f';  // the high byte of the JSON chunk's length
         return glb;
     },
     {"chunk 0"}},
    {"UnknownExtension", "a.3ds", [] { return "MM"; }, {".glb"}},
    {"EmptyPly", "a.ply", [] { return ""; }},
    {"TruncatedPly", "a.ply", [] { return ply("0 0 0\n1 0", ""); }},
    {"PlyVertexOutOfRange", "a.ply", [] { return ply(three_vertices, "3 0 1 3\n"); }, {"3"}},
    {"PlyNegativeVertex", "a.ply", [] { return ply(three_vertices, "3 0 1 -2\n"); }, {"-2"}},
    {"PlyOfTooManyVertices", "a.ply",
     [] {
         return "ply\nformat binary_little_endian 1.0\nelement vertex 4000000000000\nproperty float "
                "x\nproperty float y\n"
                "property float z\nelement face 0\nproperty list uchar int vertex_indices\nend_header\n";
     }},
    {"DamagedGzip", "a.ply.gz", [] { return "\x1f\x8b\x08 and no more"; }},
    {"ObjVertexOutOfRange", "a.obj", [] { return "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n"; }},
    {"EmptyObj", "a.obj", [] { return ""; }},
};

class BadSceneFileIs : public testing::TestWithParam<BadFile> {};

TEST_P(BadSceneFileIs, RefusedInOneLine) {
    const ScratchFolder folder;
    write_bytes(folder / GetParam().file, GetParam().bytes());
    std::vector<std::string> words = GetParam().words;
    words.push_back(GetParam().file);
    expect_refusal(render_over_old_picture(folder, {folder / GetParam().file}), folder, words, 1);
}

INSTANTIATE_TEST_SUITE_P(Cli, BadSceneFileIs, testing::ValuesIn(bad_scene_files),
                         [](const auto& bad) { return bad.param.name; });

const std::vector<BadFile> bad_environments{
    {"Empty", "e.hdr", [] { return ""; }},
    {"NoPicture", "e.exr", [] { return "not a picture"; }},
    {"TruncatedExr", "e.exr", [] { return std::string("\x76\x2f\x31\x01\x02\0\0\0channels\0", 17); }},
    {"TruncatedHdr", "e.hdr", [] { return "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 64 +X 128\n\x02\x02"; }},
    {"HugeHdr", "e.hdr",
     [] { return "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2000000000 +X 2000000000\n"; }},
    {"TruncatedPfm", "e.pfm",
     [] {
         return half(pfm_of({1, 1, 1, 1, 1, 1}));
     }},
    {"HugePfm", "e.pfm", [] { return "PF\n99999999 99999999\n-1\n"; }, {"99999999"}},
    {"OverflowingPfm", "e.pfm", [] { return "PF\n99999999999999999999 1\n-1\n"; }},
    {"PfmWithoutSize", "e.pfm", [] { return "PF\n"; }},
};

class BadEnvironmentIs : public testing::TestWithParam<BadFile> {};

TEST_P(BadEnvironmentIs, RefusedInOneLine) {
    const ScratchFolder folder;
    write_bytes(folder / "scene.gltf", tiny_gltf().dump());
    write_bytes(folder / GetParam().file, GetParam().bytes());
    std::vector<std::string> words = GetParam().words;
    words.push_back(GetParam().file);
    const std::string environment = folder / GetParam().file;
    const CommandResult result =
        render_over_old_picture(folder, {folder / "scene.gltf", "--environment", environment});
    expect_refusal(result, folder, words, 2);
}

INSTANTIATE_TEST_SUITE_P(Cli, BadEnvironmentIs, testing::ValuesIn(bad_environments),
                         [](const auto& bad) { return bad.param.name; });

TEST(CliMissing, SceneFileIsNamed) {
    const ScratchFolder folder;
    expect_refusal(render_over_old_picture(folder, {folder / "nowhere.glb"}), folder, {"nowhere.glb"}, 0);
}

TEST(CliMissing, EnvironmentFileIsNamed) {
    const ScratchFolder folder;
    write_bytes(folder / "scene.gltf", tiny_gltf().dump());
    const CommandResult result =
        render_over_old_picture(folder, {folder / "scene.gltf", "--environment", folder / "nowhere.exr"});
    expect_refusal(result, folder, {"nowhere.exr"}, 1);
}

TEST(CliMissing, FolderIsNotAScene) {
    const ScratchFolder folder;
    std::filesystem::create_directory(folder / "folder.glb");
    expect_refusal(render_over_old_picture(folder, {folder / "folder.glb"}), folder, {"folder.glb"}, 1);
}

TEST(CliMissing, NewlineInANameStillMakesOneLine) {
    const ScratchFolder folder;
    expect_refusal(render_over_old_picture(folder, {folder / "two\nlines.glb"}), folder,
                   {"two\\x0alines.glb"}, 0);
}

// ---- odd but usable: a warning, a picture, exit code 0

/// Expects the picture, exit code 0 and one warning that holds all of `words`.
void expect_warning(const CommandResult& result, const ScratchFolder& folder,
                    const std::vector<std::string>& words) {
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(line_count(result.err), 1u) << result.err;
    EXPECT_EQ(result.err.rfind("relumine: warning: ", 0), 0u) << result.err;
    for (const std::string& word : words)
        EXPECT_NE(result.err.find(word), std::string::npos) << word << "\n" << result.err;
    EXPECT_EQ(read_bytes(folder / "out.png").substr(1, 3), "PNG");
}

TEST(CliWarns, OfNegativeTexelsInTheEnvironment) {
    const ScratchFolder folder;
    write_bytes(folder / "scene.gltf", tiny_gltf().dump());
    write_bytes(folder / "sky.pfm", pfm_of({1, 1, 1, -1, 0, 0}));
    const CommandResult result =
        render_over_old_picture(folder, {folder / "scene.gltf", "--environment", folder / "sky.pfm"});
    expect_warning(result, folder, {"sky.pfm", "negative"});
}

TEST(CliWarns, OfDegenerateTriangles) {
    const ScratchFolder folder;
    json gltf = tiny_gltf();
    set_geometry(gltf, {.indices = {0, 1, 2, 0, 2, 2}});
    write_bytes(folder / "scene.gltf", gltf.dump());
    expect_warning(render_over_old_picture(folder, {folder / "scene.gltf"}), folder,
                   {"triangles without area"});
}

TEST(CliWarns, OfASceneWithoutLight) {
    const ScratchFolder folder;
    json gltf = tiny_gltf();
    gltf["materials"][0].erase("emissiveFactor");
    write_bytes(folder / "scene.gltf", gltf.dump());
    expect_warning(render_over_old_picture(folder, {folder / "scene.gltf"}), folder, {"light"});
}

TEST(CliWarns, OfOptionalExtensionsThatItDoesNotKnow) {
    const ScratchFolder folder;
    json gltf = tiny_gltf();
    gltf["extensionsUsed"] = {"EXT_from_nowhere"};
    write_bytes(folder / "scene.gltf", gltf.dump());
    expect_warning(render_over_old_picture(folder, {folder / "scene.gltf"}), folder, {"EXT_from_nowhere"});
}

}  // namespace
}  // namespace relumine::test
