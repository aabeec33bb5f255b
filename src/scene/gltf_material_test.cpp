// SPDX-License-Identifier: Apache-2.0
// Materials, textures and samplers from glTF.
#include <gtest/gtest.h>

#include "scene/readers.hpp"
#include "scene/test_files.hpp"

namespace relumine {
namespace {

using nlohmann::json;
using test::add_texture;
using test::GltfBuilder;
using test::TempFolder;

/// The scene of a triangle with this material.
SceneData read(GltfBuilder builder, json material) {
    builder.add("materials", std::move(material));
    builder.primitive()["material"] = 0;
    const TempFolder folder;
    return read_gltf(folder.write("scene.gltf", builder.json_text()));
}
Material read_material(const json& material) {
    return read(test::triangle_document(), material).materials.at(0);
}

Vec2 transformed(const TextureRef& ref, Vec2 uv) {
    const auto& m = ref.uv_transform;
    return {m[0] * uv.x + m[1] * uv.y + m[2], m[3] * uv.x + m[4] * uv.y + m[5]};
}

TEST(GltfMaterial, DefaultsAreThoseOfTheSpecification) {
    const Material m = read_material(json::object());
    EXPECT_EQ(m.base_color, Spectrum{1});
    EXPECT_EQ(m.metallic, 1);
    EXPECT_EQ(m.roughness, 1);
    EXPECT_EQ(m.ior, 1.5f);
    EXPECT_EQ(m.specular, 1);
    EXPECT_TRUE(is_black(m.emission));
    EXPECT_EQ(m.alpha_mode, AlphaMode::opaque);
    EXPECT_FALSE(m.double_sided);
    EXPECT_FALSE(m.solid);
    EXPECT_EQ(m.attenuation_distance, infinity);
}

TEST(GltfMaterial, PrimitivesWithoutMaterialGetTheDefaultOne) {
    const TempFolder folder;
    const SceneData scene = read_gltf(folder.write("scene.gltf", test::triangle_document().json_text()));
    ASSERT_EQ(scene.materials.size(), 1u);
    EXPECT_EQ(scene.meshes[0].material, MaterialId{0});
    EXPECT_EQ(scene.materials[0].metallic, 1);
}

TEST(GltfMaterial, ReadsFactors) {
    const Material m = read_material(
        {{"name", "floor"},
         {"pbrMetallicRoughness",
          {{"baseColorFactor", {0.1, 0.2, 0.3, 0.4}}, {"metallicFactor", 0.5}, {"roughnessFactor", 0.25}}},
         {"emissiveFactor", {1, 0.5, 0}},
         {"alphaMode", "MASK"},
         {"alphaCutoff", 0.75},
         {"doubleSided", true}});
    EXPECT_EQ(m.name, "floor");
    EXPECT_EQ(m.base_color, (Spectrum{0.1f, 0.2f, 0.3f}));
    EXPECT_EQ(m.base_alpha, 0.4f);
    EXPECT_EQ(m.metallic, 0.5f);
    EXPECT_EQ(m.roughness, 0.25f);
    EXPECT_EQ(m.emission, (Spectrum{1, 0.5f, 0}));
    EXPECT_EQ(m.alpha_mode, AlphaMode::mask);
    EXPECT_EQ(m.alpha_cutoff, 0.75f);
    EXPECT_TRUE(m.double_sided);
}

TEST(GltfMaterial, EmissiveStrengthMultiplies) {
    const Material m = read_material(
        {{"emissiveFactor", {1, 0.5, 0}},
         {"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", 3000000000u}}}}}});
    EXPECT_EQ(m.emission, (Spectrum{3e9f, 1.5e9f, 0}));  // more than the 32 bits that TinyGLTF would keep
}

TEST(GltfMaterial, ReadsIorSpecularTransmissionAndVolume) {
    const Material m = read_material(
        {{"extensions",
          {{"KHR_materials_ior", {{"ior", 1.25}}},
           {"KHR_materials_specular", {{"specularFactor", 0.5}, {"specularColorFactor", {1, 0.5, 2}}}},
           {"KHR_materials_transmission", {{"transmissionFactor", 0.75}}},
           {"KHR_materials_volume",
            {{"thicknessFactor", 0.01},
             {"attenuationDistance", 2},
             {"attenuationColor", {0.5, 1, 0.25}}}}}}});
    EXPECT_EQ(m.ior, 1.25f);
    EXPECT_EQ(m.specular, 0.5f);
    EXPECT_EQ(m.specular_color, (Spectrum{1, 0.5f, 2}));
    EXPECT_EQ(m.transmission, 0.75f);
    EXPECT_TRUE(m.solid);
    EXPECT_EQ(m.attenuation_distance, 2);
    EXPECT_EQ(m.attenuation_color, (Spectrum{0.5f, 1, 0.25f}));
}

TEST(GltfMaterial, VolumeWithoutThicknessIsASheet) {
    EXPECT_FALSE(read_material({{"extensions", {{"KHR_materials_volume", json::object()}}}}).solid);
}

TEST(GltfMaterial, ReadsEveryTextureAndDecodesItsImageOnce) {
    GltfBuilder builder = test::triangle_document();
    const json info = {{"index", add_texture(builder)}};
    const SceneData scene = read(
        builder, {{"pbrMetallicRoughness", {{"baseColorTexture", info}, {"metallicRoughnessTexture", info}}},
                  {"normalTexture", {{"index", 0}, {"scale", 0.5}}},
                  {"occlusionTexture", info},
                  {"emissiveTexture", info},
                  {"extensions",
                   {{"KHR_materials_specular", {{"specularTexture", info}, {"specularColorTexture", info}}},
                    {"KHR_materials_transmission", {{"transmissionTexture", info}}}}}});
    const Material& m = scene.materials.at(0);
    EXPECT_TRUE(m.base_color_texture && m.metallic_roughness_texture && m.normal_texture
                && m.emission_texture);
    EXPECT_TRUE(m.specular_texture && m.specular_color_texture && m.transmission_texture);
    EXPECT_EQ(m.normal_scale, 0.5f);
    ASSERT_EQ(scene.images.size(), 1u);
    EXPECT_EQ(scene.images[0].rgba8, (std::vector<std::uint8_t>{255, 0, 0, 255}));
}

TEST(GltfMaterial, ReadsImagesFromFiles) {
    const TempFolder folder;
    folder.write("red.png", test::red_png());
    GltfBuilder builder = test::triangle_document();
    builder.add("images", {{"uri", "red.png"}});
    builder.add("textures", {{"source", 0}});
    builder.add("materials", {{"emissiveTexture", {{"index", 0}}}});
    EXPECT_EQ(read_gltf(folder.write("scene.gltf", builder.json_text())).images.at(0).width, 1);
}

TEST(GltfMaterial, ImagesThatNothingUsesAreNotDecoded) {
    GltfBuilder builder = test::triangle_document();
    builder.add("images", {{"uri", "missing.png"}});
    EXPECT_TRUE(read(builder, json::object()).images.empty());
}

TEST(GltfMaterial, ReadsSamplers) {
    GltfBuilder builder = test::triangle_document();
    const std::size_t texture = add_texture(builder);
    builder.document["textures"][texture]["sampler"] =
        builder.add("samplers", {{"wrapS", 33071}, {"wrapT", 33648}, {"magFilter", 9728}});
    const auto ref =
        read(builder, {{"emissiveTexture", {{"index", texture}}}}).materials.at(0).emission_texture;
    ASSERT_TRUE(ref);
    EXPECT_EQ(ref->wrap_u, Wrap::clamp);
    EXPECT_EQ(ref->wrap_v, Wrap::mirror);
    EXPECT_TRUE(ref->nearest);
}

TEST(GltfMaterial, TextureTransformScalesTurnsAndMoves) {
    GltfBuilder builder = test::triangle_document();
    const json transform = {
        {"offset", {0, 1}}, {"rotation", 1.57079632679}, {"scale", {0.5, 0.5}}, {"texCoord", 1}};
    const json info = {{"index", add_texture(builder)},
                       {"extensions", {{"KHR_texture_transform", transform}}}};
    const Material m =
        read(builder, {{"emissiveTexture", info},
                       {"extensions", {{"KHR_materials_specular", {{"specularTexture", info}}}}}})
            .materials.at(0);
    for (const auto& ref : {m.emission_texture, m.specular_texture}) {
        ASSERT_TRUE(ref);
        EXPECT_EQ(ref->uv_set, 1);
        const Vec2 corner = transformed(*ref, {1, 0}), other = transformed(*ref, {0, 1});
        EXPECT_NEAR(corner.x, 0, 1e-6);  // the extension's own example: the lower left quadrant, turned
        EXPECT_NEAR(corner.y, 0.5, 1e-6);
        EXPECT_NEAR(other.x, 0.5, 1e-6);
        EXPECT_NEAR(other.y, 1, 1e-6);
    }
}

TEST(GltfMaterial, ThirdUvSetIsReplacedWithAWarning) {
    GltfBuilder builder = test::triangle_document();
    const std::size_t texture = add_texture(builder);
    const SceneData scene = read(builder, {{"emissiveTexture", {{"index", texture}, {"texCoord", 2}}}});
    EXPECT_EQ(scene.materials.at(0).emission_texture->uv_set, 0);
    ASSERT_EQ(scene.warnings.size(), 1u);
    EXPECT_NE(scene.warnings[0].find("materials[0].emissiveTexture: TEXCOORD_2"), std::string::npos);
}

TEST(GltfMaterial, TexturesWithoutImageAreIgnoredWithAWarning) {
    GltfBuilder builder = test::triangle_document();
    builder.add("textures", {{"extensions", {{"KHR_texture_basisu", {{"source", 0}}}}}});
    const SceneData scene = read(builder, {{"emissiveTexture", {{"index", 0}}}});
    EXPECT_FALSE(scene.materials.at(0).emission_texture);
    EXPECT_EQ(scene.warnings.size(), 1u);
}

TEST(GltfMaterial, ReadsClearcoatAndSheen) {
    const Material m = read_material(
        {{"extensions",
          {{"KHR_materials_clearcoat", {{"clearcoatFactor", 0.75}, {"clearcoatRoughnessFactor", 0.25}}},
           {"KHR_materials_sheen", {{"sheenColorFactor", {0.5, 0.25, 1}}, {"sheenRoughnessFactor", 0.5}}}}}});
    EXPECT_EQ(m.clearcoat, 0.75f);
    EXPECT_EQ(m.clearcoat_roughness, 0.25f);
    EXPECT_EQ(m.sheen_color, (Spectrum{0.5f, 0.25f, 1}));
    EXPECT_EQ(m.sheen_roughness, 0.5f);
    EXPECT_TRUE(is_black(read_material(json::object()).sheen_color));
}

TEST(GltfMaterial, ReadsAnisotropy) {
    GltfBuilder builder = test::triangle_document();
    const json info = {{"index", add_texture(builder)}};
    const SceneData scene = read(
        builder,
        {{"extensions",
          {{"KHR_materials_anisotropy",
            {{"anisotropyStrength", 0.75}, {"anisotropyRotation", -1.5}, {"anisotropyTexture", info}}}}}});
    const Material& m = scene.materials.at(0);
    EXPECT_EQ(m.anisotropy, 0.75f);
    EXPECT_EQ(m.anisotropy_rotation, -1.5f);
    EXPECT_TRUE(m.anisotropy_texture);
    EXPECT_TRUE(scene.warnings.empty());
    const Material plain =
        read_material({{"extensions", {{"KHR_materials_anisotropy", {{"anisotropyRotation", 1}}}}}});
    EXPECT_FALSE(is_anisotropic(plain));
    EXPECT_FALSE(is_anisotropic(read_material(json::object())));
}

TEST(GltfMaterial, TexturesOfClearcoatAndSheenAreRead) {
    GltfBuilder builder = test::triangle_document();
    const json info = {{"index", add_texture(builder)}};
    const SceneData scene =
        read(builder,
             {{"normalTexture", info},
              {"extensions",
               {{"KHR_materials_clearcoat",
                 {{"clearcoatFactor", 1}, {"clearcoatTexture", info}, {"clearcoatRoughnessTexture", info}}},
                {"KHR_materials_sheen", {{"sheenColorTexture", info}, {"sheenRoughnessTexture", info}}}}}});
    const Material& m = scene.materials.at(0);
    EXPECT_TRUE(m.clearcoat_texture && m.clearcoat_roughness_texture);
    EXPECT_TRUE(m.sheen_color_texture && m.sheen_roughness_texture);
    ASSERT_EQ(scene.warnings.size(), 1u);
    EXPECT_NE(scene.warnings[0].find("clear coat has the normals"), std::string::npos);
}

TEST(GltfMaterial, UnlitEmitsItsBaseColour) {
    GltfBuilder builder = test::triangle_document();
    const SceneData scene = read(builder, {{"pbrMetallicRoughness", {{"baseColorFactor", {0.5, 0.25, 1, 1}}}},
                                           {"extensions", {{"KHR_materials_unlit", json::object()}}}});
    const Material& m = scene.materials.at(0);
    EXPECT_EQ(m.emission, (Spectrum{0.5f, 0.25f, 1}));
    EXPECT_TRUE(is_black(m.base_color));
    EXPECT_EQ(m.specular, 0);
    EXPECT_EQ(scene.warnings.size(), 1u);
}

TEST(GltfMaterial, SpecularGlossinessIsACoatOfAnyReflectance) {
    const Material m = read_material({{"extensions",
                                       {{"KHR_materials_pbrSpecularGlossiness",
                                         {{"diffuseFactor", {0.1, 0.2, 0.3, 0.5}},
                                          {"specularFactor", {0.9, 0.6, 0.3}},
                                          {"glossinessFactor", 0.75}}}}}});
    EXPECT_EQ(m.base_color, (Spectrum{0.1f, 0.2f, 0.3f}));
    EXPECT_EQ(m.base_alpha, 0.5f);
    EXPECT_EQ(m.metallic, 0);
    EXPECT_EQ(m.roughness, 0.25f);
    EXPECT_EQ(m.specular_color, (Spectrum{0.9f, 0.6f, 0.3f}));
    EXPECT_GT(m.ior, 1000);
}

TEST(GltfMaterial, WebpPicturesAreTakenInsteadOfTheirFallback) {
    GltfBuilder builder = test::triangle_document();
    builder.add("images", {{"uri", "fallback.png"}});
    builder.add("images", {{"bufferView", builder.add_view(test::red_png())}});  // told by content
    builder.add("textures", {{"source", 0}, {"extensions", {{"EXT_texture_webp", {{"source", 1}}}}}});
    EXPECT_EQ(read(builder, {{"emissiveTexture", {{"index", 0}}}}).images.at(0).width, 1);
}

TEST(GltfMaterial, IorZeroIsAlmostAMirror) {
    GltfBuilder builder = test::triangle_document();
    const SceneData scene = read(builder, {{"extensions", {{"KHR_materials_ior", {{"ior", 0}}}}}});
    EXPECT_GT(scene.materials.at(0).ior, 100);
    EXPECT_EQ(scene.warnings.size(), 1u);
}

}  // namespace
}  // namespace relumine
