// SPDX-License-Identifier: Apache-2.0
// Damaged and hostile glTF: each input must end in one clear line that names the file, never in a crash.
#include <gtest/gtest.h>

#include <functional>

#include "relumine/error.hpp"
#include "relumine/scene.hpp"
#include "scene/test_files.hpp"

namespace relumine {
namespace {

using nlohmann::json;
using test::GltfBuilder;
using test::TempFolder;

/// The message of the error that loading ends in.
std::string error_of(const std::string& path) {
    try {
        (void)load_scene(path);
    } catch (const Error& error) {
        return error.what();
    }
    return "";
}

void expect_clear(const std::string& message, const std::string& path, const std::string& part) {
    EXPECT_EQ(message.rfind(path, 0), 0u) << message;  // begins with the file
    EXPECT_NE(message.find(part), message.npos) << message;
    EXPECT_EQ(message.find('\n'), message.npos) << message;
    EXPECT_LT(message.size(), 600u) << message;
}

struct Damage {
    std::string name;
    std::string place;  // part of the message
    std::function<void(GltfBuilder&)> apply;
};

void PrintTo(const Damage& damage, std::ostream* out) { *out << damage.name; }

/// Sets the value at a JSON pointer of the triangle's document.
Damage set(const std::string& name, const std::string& pointer, const json& value, const std::string& place) {
    return {name, place, [=](GltfBuilder& b) { b.document[json::json_pointer{pointer}] = value; }};
}
Damage with_material(const std::string& name, const json& material, const std::string& place) {
    return {name, place, [=](GltfBuilder& b) {
                b.document["materials"] = json::array({material});
                b.primitive()["material"] = 0;
            }};
}
Damage with_light(const std::string& name, const json& light, const std::string& place) {
    return {name, place, [=](GltfBuilder& b) {
                b.document["extensions"]["KHR_lights_punctual"]["lights"] = json::array({light});
                b.document["nodes"][0]["extensions"]["KHR_lights_punctual"]["light"] = 0;
            }};
}
Damage with_camera(const std::string& name, const json& camera, const std::string& place) {
    return {name, place, [=](GltfBuilder& b) {
                b.document["cameras"] = json::array({camera});
                b.document["nodes"][0]["camera"] = 0;
            }};
}
Damage with_uri(const std::string& name, const std::string& uri,
                const std::string& place = "buffers[0].uri") {
    return {name, place, [=](GltfBuilder& b) {
                b.document["buffers"] = {{{"byteLength", 44}, {"uri", uri}}};
            }};
}
Damage with_positions(const std::string& name, const std::vector<float>& positions,
                      const std::string& place) {
    return {name, place, [=](GltfBuilder& b) { b.attributes()["POSITION"] = b.add_vec3(positions); }};
}
Damage with_sparse(const std::string& name, const json& sparse, const std::string& place) {
    return {name, place, [=](GltfBuilder& b) { b.document["accessors"][0]["sparse"] = sparse; }};
}
Damage with_image(const std::string& name, const json& image, const std::string& place) {
    return {name, place, [=](GltfBuilder& b) {
                b.document["images"] = json::array({image});
                b.document["textures"] = {{{"source", 0}}};
                b.document["materials"] = {{{"emissiveTexture", {{"index", 0}}}}};
                b.primitive()["material"] = 0;
            }};
}

const float nan = std::numeric_limits<float>::quiet_NaN();
const float inf = std::numeric_limits<float>::infinity();
const std::uint64_t huge = std::uint64_t{1} << 63;

std::vector<Damage> accessor_damages() {
    return {
        set("AttributeBeyondAccessors", "/meshes/0/primitives/0/attributes/POSITION", 9,
            "attributes.\"POSITION\""),
        set("NegativeAttribute", "/meshes/0/primitives/0/attributes/POSITION", -1, "attributes.\"POSITION\""),
        set("AttributeIsText", "/meshes/0/primitives/0/attributes/POSITION", "0", "attributes.\"POSITION\""),
        set("AttributesAreAnArray", "/meshes/0/primitives/0/attributes", json::array({0}),
            "primitives[0].attributes"),
        set("UnusedAttributeBeyondAccessors", "/meshes/0/primitives/0/attributes/JOINTS_0", 70000,
            "JOINTS_0"),
        set("IndicesBeyondAccessors", "/meshes/0/primitives/0/indices", 4294967296, "primitives[0].indices"),
        set("MaterialBeyondMaterials", "/meshes/0/primitives/0/material", 0, "primitives[0].material"),
        set("UnknownMode", "/meshes/0/primitives/0/mode", 7, "primitives[0].mode"),
        set("NegativeMode", "/meshes/0/primitives/0/mode", -1, "primitives[0].mode"),
        set("ViewBeyondViews", "/accessors/0/bufferView", 5, "accessors[0].bufferView"),
        set("NegativeOffset", "/accessors/0/byteOffset", -4, "accessors[0].byteOffset"),
        set("OffsetBehindView", "/accessors/0/byteOffset", 4096,
            "accessors[0].byteOffset: expected at most 36, found 4096"),
        set("OffsetNearOverflow", "/accessors/0/byteOffset", huge - 8, "accessors[0].byteOffset"),
        set("CountTooLarge", "/accessors/0/count", 4, "accessors[0]"),
        set("CountHuge", "/accessors/0/count", 1000000000, "accessors[0]"),
        set("CountBeyondInt", "/accessors/0/count", huge, "accessors[0].count"),
        set("CountZero", "/accessors/0/count", 0, "accessors[0].count"),
        set("CountNegative", "/accessors/0/count", -3, "accessors[0].count"),
        set("CountFractional", "/accessors/0/count", 2.5, "accessors[0].count"),
        set("CountMissing", "/accessors/0/count", nullptr, "accessors[0].count"),
        set("ComponentTypeUnknown", "/accessors/0/componentType", 5124, "accessors[0].componentType"),
        set("ComponentTypeOutOfRange", "/accessors/0/componentType", 99999, "accessors[0].componentType"),
        set("TypeUnknown", "/accessors/0/type", "VEC9", "glTF document"),
        set("TypeIsNumber", "/accessors/0/type", 3, "accessors[0].type"),
        set("PositionsOfTwo", "/accessors/0/type", "VEC2", "accessors[0].type: expected VEC3, found VEC2"),
        set("PositionsAreMatrices", "/accessors/0/type", "MAT4", "accessors[0].type"),
        set("IndicesAreFloats", "/accessors/1/componentType", 5126, "accessors[1].componentType"),
        set("IndicesAreSigned", "/accessors/1/componentType", 5122, "accessors[1].componentType"),
        set("IndicesNotByThree", "/accessors/1/count", 2, "a multiple of 3"),
        {"NormalsOfOtherCount", "primitives[0].NORMAL",
         [](GltfBuilder& b) {
             b.attributes()["NORMAL"] = b.add_vec3({0, 0, 1});
         }},
        {"VertexBeyondPositions", "triangle 0: expected vertices below 3, found 65535",
         [](GltfBuilder& b) {
             b.primitive()["indices"] = b.add_indices({0, 1, 65535});
         }},
        {"ZerosWithoutEnd", "2^30",
         [](GltfBuilder& b) {
             b.document["accessors"][0].erase("bufferView");
             b.document["accessors"][0]["count"] = 2147483647;
         }},
        with_positions("NanPosition", {0, 0, 0, 1, nan, 0, 0, 1, 0}, "mesh \"triangle\": vertex 1"),
        with_positions("InfinitePosition", {0, 0, 0, 1, inf, 0, 0, 1, 0}, "mesh \"triangle\": vertex 1"),
        with_positions("PositionTooFar", {0, 0, 0, 1, 1e30f, 0, 0, 1, 0}, "mesh \"triangle\": vertex 1"),
        with_positions("NoArea", {0, 0, 0, 1, 0, 0, 2, 0, 0}, "a scene with triangles"),
        with_sparse("SparseIsNumber", 3, "accessors[0].sparse"),
        with_sparse("SparseWithoutIndices", {{"count", 1}, {"values", {{"bufferView", 0}}}},
                    "sparse.indices"),
        with_sparse("SparseCountHuge",
                    {{"count", 2147483647},
                     {"indices", {{"bufferView", 1}, {"componentType", 5123}}},
                     {"values", {{"bufferView", 0}}}},
                    "accessors[0].sparse.indices"),
        with_sparse("SparseIndexBeyondCount",
                    {{"count", 1},
                     {"indices", {{"bufferView", 0}, {"byteOffset", 12}, {"componentType", 5125}}},
                     {"values", {{"bufferView", 0}}}},
                    "accessors[0].sparse.indices: element 0"),
        with_sparse("SparseValuesTooShort",
                    {{"count", 3},
                     {"indices", {{"bufferView", 1}, {"componentType", 5123}}},
                     {"values", {{"bufferView", 1}}}},
                    "accessors[0].sparse.values"),
        with_sparse("SparseNegativeOffset",
                    {{"count", 1},
                     {"indices", {{"bufferView", 1}, {"byteOffset", -1}, {"componentType", 5123}}},
                     {"values", {{"bufferView", 0}}}},
                    "sparse.indices.byteOffset"),
    };
}

std::vector<Damage> buffer_damages() {
    return {
        set("BufferBeyondBuffers", "/bufferViews/0/buffer", 1, "bufferViews[0].buffer"),
        set("ViewOffsetBehindBuffer", "/bufferViews/0/byteOffset", 45, "bufferViews[0].byteOffset"),
        set("ViewLengthBehindBuffer", "/bufferViews/0/byteLength", 50, "bufferViews[0].byteLength"),
        set("ViewLengthNearOverflow", "/bufferViews/0/byteLength", ~std::uint64_t{0},
            "bufferViews[0].byteLength"),
        set("ViewLengthZero", "/bufferViews/0/byteLength", 0, "bufferViews[0].byteLength"),
        set("ViewLengthNegative", "/bufferViews/0/byteLength", -1, "bufferViews[0].byteLength"),
        set("StrideTooSmall", "/bufferViews/0/byteStride", 3, "bufferViews[0].byteStride"),
        set("StrideTooLarge", "/bufferViews/0/byteStride", 1000, "bufferViews[0].byteStride"),
        set("StrideNegative", "/bufferViews/0/byteStride", -12, "bufferViews[0].byteStride"),
        set("StrideNotByFour", "/bufferViews/0/byteStride", 22, "byteStride"),
        set("StrideLeavesView", "/bufferViews/0/byteStride", 16, "accessors[0]"),
        set("BuffersAreAnObject", "/buffers", json::object(), "buffers"),
        set("BufferIsNumber", "/buffers", json::array({1}), "buffers[0]"),
        set("NoUriOutsideGlb", "/buffers", json::array({{{"byteLength", 44}}}), "buffers[0].uri"),
        set("NoBuffers", "/buffers", json::array(), "bufferViews[0].buffer"),
        with_uri("DataWithForeignCharacter", "data:application/octet-stream;base64,AAAA*AAA"),
        with_uri("DataCutShort", "data:application/octet-stream;base64,AAAAA"),
        with_uri("DataTooShort", "data:application/octet-stream;base64,AAAA", "buffers[0].byteLength"),
        with_uri("DataNotBase64", "data:text/plain,hello"),
        with_uri("DataWithoutComma", "data:application/octet-stream;base64"),
        with_uri("MissingFile", "missing.bin"),
        with_uri("EmptyUri", ""),
        with_uri("ParentFolder", "../outside.bin"),
        with_uri("ParentFolderInDisguise", "a/../../outside.bin"),
        with_uri("ParentFolderEncoded", "%2e%2e/outside.bin"),
        with_uri("AbsolutePath", "/etc/passwd"),
        with_uri("AbsolutePathEncoded", "%2Fetc%2Fpasswd"),
        with_uri("ZeroByte", "a%00b"),
        with_uri("BrokenEscape", "a%2"),
        with_uri("Network", "https://example.org/a.bin"),
        with_uri("FileUri", "file:///etc/passwd"),
        with_uri("Folder", "."),
        with_image("ImageWithBoth", {{"uri", "a.png"}, {"bufferView", 0}}, "images[0]"),
        with_image("ImageWithNothing", json::object(), "images[0]"),
        with_image("ImageViewBeyondViews", {{"bufferView", 9}}, "images[0].bufferView"),
        with_image("ImageOfNoise", {{"bufferView", 0}, {"name", "noise"}}, "images[0] \"noise\""),
        with_image("ImageMissing", {{"uri", "missing.png"}}, "images[0]"),
        with_image("ImageOutside", {{"uri", "../../etc/passwd"}}, "images[0]"),
    };
}

std::vector<Damage> node_damages() {
    return {
        set("MeshBeyondMeshes", "/nodes/0/mesh", 1, "nodes[0].mesh"),
        set("ChildBeyondNodes", "/nodes/0/children", {3}, "nodes[0].children[0]"),
        set("ChildrenAreNumber", "/nodes/0/children", 3, "nodes[0].children"),
        set("ItsOwnParent", "/nodes/0/children", {0}, "nodes[0]"),
        set("CycleOfTwo", "/nodes", {{{"mesh", 0}, {"children", {1}}}, {{"children", {0}}}}, "nodes[0]"),
        set("CycleBesideTheScene", "/nodes", {{{"mesh", 0}}, {{"children", {2}}}, {{"children", {1}}}},
            "nodes[1]"),
        set("TwoParents", "/nodes", {{{"children", {2}}}, {{"children", {2}}}, {{"mesh", 0}}}, "nodes[2]"),
        set("ChildTwice", "/nodes", {{{"children", {1, 1}}}, {{"mesh", 0}}}, "nodes[1]"),
        set("RootTwice", "/scenes/0/nodes", {0, 0}, "nodes[0]"),
        set("RootBeyondNodes", "/scenes/0/nodes", {1}, "scenes[0].nodes[0]"),
        set("SceneBeyondScenes", "/scene", 1, "scene"),
        set("SceneIsText", "/scene", "first", "scene"),
        set("EmptyScene", "/scenes/0/nodes", json::array(), "a scene with triangles"),
        set("NodesAreAnObject", "/nodes", json::object(), "nodes"),
        set("NodeIsNumber", "/nodes", json::array({1}), "nodes[0]"),
        set("NodeIsNull", "/nodes", json::array({nullptr}), "nodes[0]"),
        set("MatrixOf15", "/nodes/0/matrix", json::array({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0}),
            "nodes[0].matrix"),
        set("MatrixOfText", "/nodes/0/translation", {"a", "b", "c"}, "nodes[0].translation[0]"),
        set("PerspectiveMatrix", "/nodes/0/matrix", {1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1},
            "nodes[0].matrix"),
        set("RotationZero", "/nodes/0/rotation", {0, 0, 0, 0}, "nodes[0].rotation"),
        set("TranslationTooLarge", "/nodes/0/translation", {1e300, 0, 0}, "nodes[0].translation[0]"),
        set("TranslationFar", "/nodes/0/translation", {1e30, 0, 0}, "mesh \"triangle\""),
        set("ScaledFlat", "/nodes/0/scale", {0, 1, 1}, "a scene with triangles"),
        set("MeshesAreText", "/meshes", "triangle", "meshes"),
        set("PrimitivesMissing", "/meshes/0", json::object(), "meshes[0].primitives"),
        set("NameIsNumber", "/meshes/0/name", 3, "meshes[0].name"),
        set("AssetMissing", "/asset", nullptr, "asset"),
        set("VersionOne", "/asset/version", "1.0", "asset.version"),
        set("VersionIsNumber", "/asset/version", 2.0, "asset.version"),
        set("NewerMinimum", "/asset/minVersion", "2.1", "asset.minVersion"),
        set("UnknownRequiredExtension", "/extensionsRequired", {"XYZ_magic"}, "\"XYZ_magic\""),
        set("BasisRequired", "/extensionsRequired", {"KHR_texture_basisu"}, "\"KHR_texture_basisu\""),
        set("RequiredIsText", "/extensionsRequired", "KHR_materials_ior", "extensionsRequired"),
    };
}

std::vector<Damage> content_damages() {
    const json perspective = {{"yfov", 0.5}, {"znear", 0.1}};
    return {
        with_material("RoughnessTooLarge",
                      {{"name", "floor"}, {"pbrMetallicRoughness", {{"roughnessFactor", 3.5}}}},
                      "material \"floor\": expected roughness in [0, 1], found 3.5"),
        with_material("ColorNegative", {{"pbrMetallicRoughness", {{"baseColorFactor", {-1, 0, 0, 1}}}}},
                      "base colour"),
        with_material("ColorOfThree", {{"pbrMetallicRoughness", {{"baseColorFactor", {1, 0, 0}}}}},
                      "baseColorFactor"),
        with_material("MetallicIsText", {{"pbrMetallicRoughness", {{"metallicFactor", "1"}}}},
                      "metallicFactor"),
        with_material("EmissionNegative", {{"emissiveFactor", {-1, 0, 0}}}, "emission"),
        with_material("EmissionOverflows",
                      {{"emissiveFactor", {1e30, 0, 0}},
                       {"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", 1e30}}}}}},
                      "emission"),
        with_material("AlphaModeUnknown", {{"alphaMode", "GLASS"}}, "materials[0].alphaMode"),
        with_material("DoubleSidedIsNumber", {{"doubleSided", 1}}, "materials[0].doubleSided"),
        with_material("IorBelowOne", {{"extensions", {{"KHR_materials_ior", {{"ior", 0.5}}}}}}, "ior"),
        with_material("ExtensionIsArray", {{"extensions", {{"KHR_materials_ior", json::array({1})}}}},
                      "KHR_materials_ior"),
        with_material("TextureBeyondTextures", {{"normalTexture", {{"index", 0}}}},
                      "materials[0].normalTexture.index"),
        with_material("TextureWithoutIndex", {{"normalTexture", json::object()}}, "normalTexture.index"),
        with_material("SpecularTextureBeyondTextures",
                      {{"extensions", {{"KHR_materials_specular", {{"specularTexture", {{"index", 7}}}}}}}},
                      "specularTexture.index"),
        with_material("AnisotropyTooStrong",
                      {{"extensions", {{"KHR_materials_anisotropy", {{"anisotropyStrength", 1.5}}}}}},
                      "expected anisotropy in [0, 1], found 1.5"),
        with_material("AnisotropyRotationIsText",
                      {{"extensions", {{"KHR_materials_anisotropy", {{"anisotropyRotation", "north"}}}}}},
                      "anisotropyRotation"),
        with_material(
            "AnisotropyTextureBeyondTextures",
            {{"extensions", {{"KHR_materials_anisotropy", {{"anisotropyTexture", {{"index", 3}}}}}}}},
            "anisotropyTexture.index"),
        with_material("ClearcoatTooStrong",
                      {{"extensions", {{"KHR_materials_clearcoat", {{"clearcoatFactor", 1.5}}}}}},
                      "expected clearcoat in [0, 1], found 1.5"),
        with_material("ClearcoatRoughnessNegative",
                      {{"extensions", {{"KHR_materials_clearcoat", {{"clearcoatRoughnessFactor", -1}}}}}},
                      "clearcoat roughness"),
        with_material("ClearcoatIsNumber", {{"extensions", {{"KHR_materials_clearcoat", 1}}}},
                      "KHR_materials_clearcoat: expected an object, found 1"),
        with_material(
            "ClearcoatNormalBeyondTextures",
            {{"extensions", {{"KHR_materials_clearcoat", {{"clearcoatNormalTexture", {{"index", 0}}}}}}}},
            "clearcoatNormalTexture.index"),
        with_material("SheenOfTwo",
                      {{"extensions", {{"KHR_materials_sheen", {{"sheenColorFactor", {1, 1}}}}}}},
                      "sheenColorFactor: expected 3 elements, found 2"),
        with_material("SheenTooBright",
                      {{"extensions", {{"KHR_materials_sheen", {{"sheenColorFactor", {2, 1, 1}}}}}}},
                      "sheen colour"),
        with_material("SheenRoughnessIsText",
                      {{"extensions", {{"KHR_materials_sheen", {{"sheenRoughnessFactor", "1"}}}}}},
                      "sheenRoughnessFactor"),
        with_material("GlossinessTooLarge",
                      {{"extensions", {{"KHR_materials_pbrSpecularGlossiness", {{"glossinessFactor", 3}}}}}},
                      "roughness"),
        with_material("UnlitIsArray", {{"extensions", {{"KHR_materials_unlit", json::array()}}}},
                      "KHR_materials_unlit: expected an object"),
        {"WebpBeyondImages", "textures[0].extensions.EXT_texture_webp.source",
         [](GltfBuilder& b) {
             b.document["textures"] = {{{"extensions", {{"EXT_texture_webp", {{"source", 0}}}}}}};
         }},
        {"WebpOfNoise", "images[0]",
         [](GltfBuilder& b) {
             b.document["images"] = {{{"bufferView", b.add_view("RIFF\x10\x01\x01\x01WEBPVP8L........")}}};
             b.document["textures"] = {{{"extensions", {{"EXT_texture_webp", {{"source", 0}}}}}}};
             b.document["materials"] = {{{"emissiveTexture", {{"index", 0}}}}};
             b.primitive()["material"] = 0;
         }},
        {"ImageBeyondImages", "textures[0].source",
         [](GltfBuilder& b) {
             b.document["textures"] = {{{"source", 0}}};
         }},
        {"WrapModeUnknown", "samplers[0]",
         [](GltfBuilder& b) {
             const std::size_t texture = test::add_texture(b);
             b.document["textures"][texture]["sampler"] = b.add("samplers", {{"wrapS", 20000}});
             b.document["materials"] = {{{"emissiveTexture", {{"index", texture}}}}};
         }},
        with_light("LightTypeUnknown", {{"type", "laser"}}, "lights[0].type"),
        with_light("LightTypeMissing", {{"intensity", 1}}, "lights[0].type"),
        with_light("LightNegative", {{"type", "point"}, {"intensity", -1}}, "lights[0].intensity"),
        with_light("LightColorOfTwo", {{"type", "point"}, {"color", {1, 1}}}, "lights[0].color"),
        with_light("LightColorNegative", {{"type", "point"}, {"color", {-1, 1, 1}}}, "point light 0"),
        with_light("SpotMissing", {{"type", "spot"}}, "glTF document"),
        with_light("SpotInsideOut",
                   {{"type", "spot"}, {"spot", {{"innerConeAngle", 1}, {"outerConeAngle", 0.5}}}},
                   "lights[0].spot.innerConeAngle"),
        with_light("SpotTooWide", {{"type", "spot"}, {"spot", {{"outerConeAngle", 3}}}}, "outerConeAngle"),
        {"LightBeyondLights", "nodes[0].extensions.KHR_lights_punctual.light",
         [](GltfBuilder& b) { b.document["nodes"][0]["extensions"]["KHR_lights_punctual"]["light"] = 0; }},
        set("LightsAreAnObject", "/extensions", {{"KHR_lights_punctual", {{"lights", json::object()}}}},
            "lights"),
        with_camera("CameraTypeUnknown", {{"type", "fisheye"}, {"perspective", perspective}},
                    "glTF document"),
        with_camera("CameraWithoutType", {{"perspective", perspective}}, "cameras[0].type"),
        with_camera("CameraWithoutProjection", {{"type", "perspective"}}, "glTF document"),
        with_camera("FieldOfViewZero",
                    {{"type", "perspective"}, {"perspective", {{"yfov", 0}, {"znear", 0.1}}}}, "yfov"),
        with_camera("FieldOfViewTooLarge",
                    {{"type", "perspective"}, {"perspective", {{"yfov", 4}, {"znear", 0.1}}}}, "yfov"),
        with_camera("OrthographicFlat",
                    {{"type", "orthographic"},
                     {"orthographic", {{"xmag", 1}, {"ymag", 0}, {"znear", 0}, {"zfar", 1}}}},
                    "cameras[0].orthographic"),
        set("CameraBeyondCameras", "/nodes/0/camera", 0, "nodes[0].camera"),
    };
}

class GltfDamage : public testing::TestWithParam<Damage> {};

TEST_P(GltfDamage, EndsInOneClearLine) {
    const TempFolder folder;
    GltfBuilder builder = test::triangle_document();
    GetParam().apply(builder);
    const std::string path = folder.write("scene.gltf", builder.json_text());
    expect_clear(error_of(path), path, GetParam().place);
}

std::string damage_name(const testing::TestParamInfo<Damage>& info) { return info.param.name; }
INSTANTIATE_TEST_SUITE_P(Accessor, GltfDamage, testing::ValuesIn(accessor_damages()), damage_name);
INSTANTIATE_TEST_SUITE_P(Buffer, GltfDamage, testing::ValuesIn(buffer_damages()), damage_name);
INSTANTIATE_TEST_SUITE_P(Node, GltfDamage, testing::ValuesIn(node_damages()), damage_name);
INSTANTIATE_TEST_SUITE_P(Content, GltfDamage, testing::ValuesIn(content_damages()), damage_name);

}  // namespace
}  // namespace relumine
