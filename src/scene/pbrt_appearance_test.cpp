// SPDX-License-Identifier: Apache-2.0
// What pbrt scenes look like: materials, textures, lights and spectra.
#include "base/equal_area.hpp"
#include "image/byte_image.hpp"
#include "relumine/error.hpp"
#include "scene/pbrt_spectrum.hpp"
#include "scene/pbrt_test_scenes.hpp"
#include "scene/pbrt_transform.hpp"

namespace relumine {
namespace {

using namespace test::pbrt;
using test::TempFolder;

Material material(const std::string& directive) { return read(directive + '\n' + triangle).materials.at(0); }

TEST(PbrtMaterials, DiffuseIsLambert) {
    const Material m = material("Material \"diffuse\" \"rgb reflectance\" [.1 .2 .3]");
    EXPECT_EQ(m.base_color, (Spectrum{.1f, .2f, .3f}));
    EXPECT_EQ(m.metallic, 0);
    EXPECT_EQ(m.specular, 0);
    EXPECT_EQ(material("Material \"diffuse\"").base_color, Spectrum{0.5f});
    EXPECT_EQ(material("").base_color, Spectrum{0.5f});
}

TEST(PbrtMaterials, RoughnessIsRemappedUnlessToldOtherwise) {  // α = √roughness, ours is √α
    EXPECT_FLOAT_EQ(material("Material \"conductor\" \"float roughness\" .0625").roughness, 0.5f);
    EXPECT_FLOAT_EQ(
        material("Material \"conductor\" \"float roughness\" .25 \"bool remaproughness\" false").roughness,
        0.5f);
    EXPECT_EQ(material("Material \"conductor\"").roughness, 0);
}

/// A material's α along u and along v.
std::array<float, 2> alphas(const Material& m) {
    const float across = sqr(m.roughness), along = lerp(across, 1.0f, sqr(m.anisotropy));
    if (m.anisotropy_rotation == 0) return {along, across};
    EXPECT_FLOAT_EQ(m.anisotropy_rotation, pi / 2);
    return {across, along};
}

TEST(PbrtMaterials, RoughnessMayDifferAlongUAndV) {
    const auto expect_alphas = [](const std::string& directive, float u, float v) {
        const SceneData scene = read(directive + '\n' + triangle);
        const auto [found_u, found_v] = alphas(scene.materials.at(0));
        EXPECT_NEAR(found_u, u, 1e-6f) << directive;
        EXPECT_NEAR(found_v, v, 1e-6f) << directive;
        for (const std::string& w : scene.warnings) EXPECT_EQ(w.find("roughness"), w.npos) << w;
        if (u != v) {
            EXPECT_EQ(scene.meshes.at(0).uvs[0].size(), 3u) << "pbrt's default coordinates";
            EXPECT_TRUE(scene.meshes.at(0).facet_tangents);
        }
    };
    const std::string rough = " \"float uroughness\" .04 \"float vroughness\" .16";
    for (const char* kind : {"conductor", "dielectric", "coateddiffuse"}) {
        const std::string directive = std::string{"Material \""} + kind + '"';
        expect_alphas(directive + rough, .2f, .4f);
        expect_alphas(directive + rough + " \"bool remaproughness\" false", .04f, .16f);
        expect_alphas(directive + " \"float roughness\" .25 \"float uroughness\" .36", .6f, .5f);
        expect_alphas(directive + " \"float uroughness\" .09 \"float vroughness\" .09", .3f, .3f);
        expect_alphas(directive + " \"float uroughness\" 0 \"float vroughness\" .09", 0, .3f);
    }
    expect_alphas(
        "Material \"coatedconductor\" \"float conductor.uroughness\" .04 \"float "
        "conductor.vroughness\" .16",
        .2f, .4f);
    EXPECT_FALSE(is_anisotropic(material("Material \"conductor\" \"float uroughness\" 0")));
}

TEST(PbrtMaterials, TexturesOfBothRoughnessesBecomeAnOrientation) {
    const Material m = material(
        "Texture \"t\" \"float\" \"checkerboard\" \"float tex1\" .04 \"float tex2\" .16\n"
        "Material \"conductor\" \"texture uroughness\" \"t\" \"float vroughness\" .09");
    EXPECT_TRUE(m.metallic_roughness_texture && m.anisotropy_texture);
    EXPECT_EQ(m.anisotropy, 1);
    EXPECT_EQ(m.roughness, 1);
}

TEST(PbrtMaterials, ConductorsReflectWhatTheirIndicesSay) {
    const Material copper = material("Material \"conductor\"");
    EXPECT_EQ(copper.metallic, 1);
    expect_near(copper.base_color, {.9545f, .638f, .5381f}, 1e-3f);
    expect_near(
        material("Material \"conductor\" \"spectrum eta\" \"metal-Al-eta\" \"spectrum k\" \"metal-Al-k\"")
            .base_color,
        {.9132f, .9215f, .9244f}, 1e-3f);
    expect_near(material("Material \"conductor\" \"rgb reflectance\" [.9 .8 .7]").base_color,
                {.9f, .8f, .7f});
    expect_near(material("Material \"conductor\" \"rgb eta\" [1 1 1] \"rgb k\" [2 2 2]").base_color,
                Spectrum{0.5f});
}

TEST(PbrtMaterials, DielectricsRefract) {
    const Material glass = material("Material \"dielectric\" \"float eta\" 1.33");
    EXPECT_EQ(glass.transmission, 1);
    EXPECT_TRUE(glass.solid);
    EXPECT_FLOAT_EQ(glass.ior, 1.33f);
    EXPECT_FLOAT_EQ(material("Material \"dielectric\" \"spectrum eta\" \"glass-BK7\"").ior, 1.5168f);
    const Material sheet = material("Material \"thindielectric\"");
    EXPECT_FALSE(sheet.solid);
    EXPECT_FLOAT_EQ(sheet.ior, 1.5f);
}

TEST(PbrtMaterials, CoatedDiffuseLosesLightInItsCoat) {
    const Material m =
        material("Material \"coateddiffuse\" \"rgb reflectance\" [0 .5 1] \"float thickness\" 0");
    EXPECT_TRUE(m.coated_diffuse);
    EXPECT_EQ(m.base_color.r, 0);
    const double inside = 0.596, once = 0.5 / 2.25;  // of η = 1.5
    EXPECT_NEAR(m.base_color.g, 0.908 * once * (1 - std::pow(0.5 * inside, 5)) / (1 - 0.5 * inside), 1e-3);
    const Material thick =
        material("Material \"coateddiffuse\" \"rgb reflectance\" [0 .5 1] \"float thickness\" .1");
    EXPECT_LT(thick.base_color.g, 0.9f * m.base_color.g);
}

TEST(PbrtMaterials, DiffuseTransmissionHasBothSides) {
    const Material m = material(
        "Material \"diffusetransmission\" \"rgb reflectance\" [.2 .2 .2] \"rgb transmittance\" [.4 .2 0] "
        "\"float scale\" .5");
    expect_near(m.base_color, Spectrum{0.1f});
    expect_near(m.diffuse_transmission, {0.2f, 0.1f, 0});
}

TEST(PbrtMaterials, MixedMatteColoursAreExact) {
    const std::string two =
        "MakeNamedMaterial \"a\" \"string type\" \"diffuse\" \"rgb reflectance\" [1 0 0]\n"
        "MakeNamedMaterial \"b\" \"string type\" \"diffuse\" \"rgb reflectance\" [0 0 1]\n";
    const Material m =
        material(two + "Material \"mix\" \"string materials\" [\"a\" \"b\"] \"float amount\" .25");
    expect_near(m.base_color, {.75f, 0, .25f});
}

TEST(PbrtMaterials, NamesMayComeLater) {
    const SceneData scene =
        read(std::string{"NamedMaterial \"red\"\n"} + triangle
             + "MakeNamedMaterial \"red\" \"string type\" \"diffuse\" \"rgb reflectance\" [1 0 0]");
    EXPECT_EQ(scene.materials.at(0).base_color, (Spectrum{1, 0, 0}));
}

TEST(PbrtMaterials, AttributesFillIn) {
    const Material m =
        material("Attribute \"material\" \"rgb reflectance\" [.3 .3 .3]\nMaterial \"diffuse\"");
    EXPECT_EQ(m.base_color, Spectrum{0.3f});
}

TEST(PbrtMaterials, InterfacesAreNotSeen) {
    EXPECT_EQ(read(std::string{triangle} + "Material \"interface\"\n" + triangle).meshes.size(), 1u);
}

TEST(PbrtMaterials, UnsupportedOnesWarnByNameAndPlace) {
    EXPECT_TRUE(warns(read(std::string{"Material \"subsurface\"\n"} + triangle),
                      "scene.pbrt:3:1: material \"subsurface\" is not supported"));
}

TEST(PbrtMaterials, ConstantAlphaCutsOut) {
    const auto alpha = [](const std::string& value) {
        return read("Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"float alpha\" " + value + "\n"
                    + triangle);
    };
    EXPECT_EQ(alpha("0").meshes.size(), 1u);
    EXPECT_EQ(alpha("0.5").materials.at(0).base_alpha, 0.5f);
    EXPECT_EQ(alpha("0.5").materials.at(0).alpha_mode, AlphaMode::blend);
}

/// The 16-bit texel as linear numbers.
Spectrum texel(const ByteImage& image, std::size_t i, bool srgb) {
    const auto c = [&](std::size_t k) {
        const double x = image.rgba16.at(4 * i + k) / 65535.0;
        return static_cast<float>(!srgb ? x : x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4));
    };
    return {c(0), c(1), c(2)};
}

TEST(PbrtTextures, CheckerboardsAreFourCells) {
    const SceneData scene = read(
        "Texture \"c\" \"spectrum\" \"checkerboard\" \"rgb tex1\" [.8 0 0] \"rgb tex2\" [0 .8 0] "
        "\"float uscale\" 4\nMaterial \"diffuse\" \"texture reflectance\" \"c\"\n"
        + std::string{triangle});
    const ByteImage& image = scene.images.at(0);
    ASSERT_EQ(image.width, 2);
    expect_near(texel(image, 2, true), {.8f, 0, 0}, 1e-4f);  // lower left: u, v in the first cell
    expect_near(texel(image, 0, true), {0, .8f, 0}, 1e-4f);
    expect_near(texel(image, 1, true), {.8f, 0, 0}, 1e-4f);
    const TextureRef& ref = *scene.materials.at(0).base_color_texture;
    EXPECT_TRUE(ref.nearest);
    EXPECT_EQ(ref.uv_transform[0], 2);
    EXPECT_EQ(scene.meshes.at(0).uvs[0].size(), 3u);  // pbrt's own coordinates of triangles without
}

/// Upper row red and green, lower row blue and white.
void write_picture(const TempFolder& folder) {
    const std::vector<std::uint8_t> rgb{255, 0, 0, 0, 255, 0, 0, 0, 255, 255, 255, 255};
    const auto png = encode_png(2, 2, rgb);
    (void)folder.write("p.png", {reinterpret_cast<const char*>(png.data()), png.size()});
}

TEST(PbrtTextures, ImagesKeepTheirFileAndOffsets) {
    const TempFolder folder;
    write_picture(folder);
    const SceneData scene = read(folder,
                                 "Texture \"i\" \"spectrum\" \"imagemap\" \"string filename\" \"p.png\" "
                                 "\"float vscale\" 3 \"float vdelta\" .25 \"string wrap\" \"clamp\"\n"
                                 "Material \"diffuse\" \"texture reflectance\" \"i\"\n"
                                     + std::string{triangle});
    EXPECT_EQ(scene.images.at(0).rgba8.size(), 16u);
    const TextureRef& ref = *scene.materials.at(0).base_color_texture;
    EXPECT_EQ(ref.wrap_u, Wrap::clamp);
    // pbrt reads the picture at height 1 − (3 v + ¼) from above; our coordinate is 1 − v
    for (const float v : {0.0f, 0.1f, 0.5f})
        EXPECT_NEAR(ref.uv_transform[4] * (1 - v) + ref.uv_transform[5], 1 - (3 * v + 0.25f), 1e-6f);
}

TEST(PbrtTextures, ScaleInvertAndMixWorkTexelByTexel) {
    const TempFolder folder;
    write_picture(folder);
    const SceneData scene = read(
        folder,
        "Texture \"i\" \"spectrum\" \"imagemap\" \"string filename\" \"p.png\" \"bool invert\" true\n"
        "Texture \"h\" \"spectrum\" \"scale\" \"texture tex\" \"i\" \"float scale\" .5\n"
        "Texture \"m\" \"spectrum\" \"mix\" \"texture tex1\" \"h\" \"rgb tex2\" [1 1 1] \"float amount\" .5\n"
        "Material \"diffuse\" \"texture reflectance\" \"m\"\n"
            + std::string{triangle});
    expect_near(texel(scene.images.at(0), 0, true), {.5f, .75f, .75f}, 1e-4f);
    expect_near(texel(scene.images.at(0), 3, true), Spectrum{.5f}, 1e-4f);
}

TEST(PbrtTextures, FloatTexturesDriveRoughness) {
    const TempFolder folder;
    write_picture(folder);
    const SceneData scene = read(folder,
                                 "Texture \"r\" \"float\" \"imagemap\" \"string filename\" \"p.png\" "
                                 "\"string encoding\" \"linear\"\n"
                                 "Material \"conductor\" \"texture roughness\" \"r\"\n"
                                     + std::string{triangle});
    EXPECT_NEAR(texel(scene.images.at(0), 0, false).g, std::pow(1.0 / 3, 0.25), 1e-4);
    EXPECT_NEAR(texel(scene.images.at(0), 3, false).g, 1, 1e-4);
}

TEST(PbrtTextures, PlanarMappingsReadPositions) {
    const TempFolder folder;
    write_picture(folder);
    const SceneData scene =
        read(folder,
             "Translate 0 0 5\n"
             "Texture \"i\" \"spectrum\" \"imagemap\" \"string filename\" \"p.png\" "
             "\"string mapping\" \"planar\" \"vector3 v1\" [2 0 0] \"vector3 v2\" [0 0 1]\n"
             "Material \"diffuse\" \"texture reflectance\" \"i\"\n"
                 + std::string{triangle});
    const Mesh& mesh = scene.meshes.at(0);
    EXPECT_EQ(scene.materials.at(0).base_color_texture->uv_set, 1);
    ASSERT_NE(mesh.projection, nullptr);
    EXPECT_EQ(mesh.projection->kind, TextureProjection::Kind::planar);
    // s = 2 x; t = z of the texture's space
    expect_near(mesh.projection->texture_from_world.point({1, 0, 5.5f}), {2, 0.5f, 0.5f});
}

TEST(PbrtTextures, OneDirectionForAMaterial) {
    const auto mix = [](const std::string& name, const std::string& dir) {
        return "Texture \"" + name + "\" \"float\" \"directionmix\" \"vector3 dir\" [" + dir + "]\n";
    };
    const std::string glossy =
        "Material \"conductor\" \"texture uroughness\" \"a\" \"texture vroughness\" \"b\"\n";
    EXPECT_FALSE(warns(read(mix("a", "0 1 0") + mix("b", "0 2 0") + glossy + triangle), "directions"));
    EXPECT_TRUE(warns(read(mix("a", "0 1 0") + mix("b", "1 0 0") + glossy + triangle), "several directions"));
    EXPECT_THROW(
        (void)read(mix("a", "0 0 0") + "Material \"conductor\" \"texture roughness\" \"a\"\n" + triangle),
        SceneError);
}

TEST(PbrtLights, PointsSpotsAndDistantOnes) {
    const SceneData scene = read(std::string{triangle}
                                 + "Translate 1 0 0\n"
                                   "LightSource \"point\" \"rgb I\" [1 2 3] \"float scale\" 2 \"point3 from\" [0 5 0]\n"
                                   "LightSource \"point\" \"float power\" 12.566370614\n"
                                   "LightSource \"spot\" \"point3 to\" [0 -1 0] \"float coneangle\" 60 \"float "
                                   "conedeltaangle\" 15\n"
                                   "LightSource \"distant\" \"point3 from\" [0 2 0] \"point3 to\" [0 0 0] \"rgb L\" [3 3 3]\n");
    ASSERT_EQ(scene.point_lights.size(), 2u);
    expect_near(scene.point_lights[0].position, {1, 5, 0});
    expect_near(scene.point_lights[0].intensity, {2, 4, 6});
    expect_near(scene.point_lights[1].intensity, Spectrum{1});
    const SpotLight& spot = scene.spot_lights.at(0);
    expect_near(spot.direction, {0, -1, 0});
    EXPECT_NEAR(spot.cos_outer, 0.5f, 1e-6f);
    EXPECT_NEAR(spot.cos_inner, std::sqrt(0.5f), 1e-6f);
    EXPECT_TRUE(spot.smoothstep);
    expect_near(scene.directional_lights.at(0).direction, {0, -1, 0});
    expect_near(scene.directional_lights[0].irradiance, Spectrum{3});
}

TEST(PbrtLights, AreaLightsEmitTheirRadianceOrPower) {
    const auto emission = [](const std::string& light) {
        return read("AreaLightSource \"diffuse\" " + light + '\n' + triangle).materials.at(0);
    };
    expect_near(emission("\"rgb L\" [1 2 3] \"float scale\" 2").emission, {2, 4, 6});
    expect_near(emission("").emission, Spectrum{1});
    EXPECT_FALSE(emission("").double_sided);
    EXPECT_TRUE(emission("\"bool twosided\" true").double_sided);
    const float half = 0.5f;  // the triangle's area
    expect_near(emission("\"float power\" 5").emission, Spectrum{5 / (half * pi)}, 1e-4f);
    expect_near(emission("\"float power\" 5 \"bool twosided\" true").emission, Spectrum{5 / (2 * half * pi)},
                1e-4f);
}

TEST(PbrtLights, UniformSkiesAreSummed) {
    const SceneData scene = read(std::string{triangle}
                                 + "LightSource \"infinite\" \"rgb L\" [1 2 3] \"float scale\" 2\n"
                                   "LightSource \"infinite\" \"float illuminance\" 6.2831853\n");
    ASSERT_TRUE(scene.environment);
    for (const Spectrum& texel : scene.environment->radiance) expect_near(texel, {4, 6, 8});
}

TEST(PbrtLights, ObjectsDoNotShine) {
    const SceneData scene = read(std::string{"ObjectBegin \"a\" AreaLightSource \"diffuse\"\n"} + triangle
                                 + "ObjectEnd ObjectInstance \"a\"");
    EXPECT_TRUE(is_black(scene.materials.at(0).emission));
    EXPECT_TRUE(warns(scene, "area lights do not shine in objects"));
}

TEST(PbrtLights, FilmSensitivityScalesLight) {
    const SceneData scene =
        read(std::string{triangle} + "LightSource \"point\"", "Film \"rgb\" \"float iso\" 200");
    expect_near(scene.point_lights.at(0).intensity, Spectrum{2});
}

TEST(EqualArea, SquareAndSphereAreInverse) {
    for (int i = 0; i < 40; ++i)
        for (int j = 0; j < 40; ++j) {
            const double u = (i + 0.37) / 40, v = (j + 0.61) / 40;
            const auto d = equal_area_direction(u, v);
            EXPECT_NEAR(std::hypot(d[0], d[1], d[2]), 1, 1e-12);
            const Vec2 back = equal_area_square(d);
            EXPECT_NEAR(double{back.x}, u, 1e-6);
            EXPECT_NEAR(double{back.y}, v, 1e-6);
        }
    EXPECT_NEAR(equal_area_direction(0.5, 0.5)[2], 1, 1e-12);  // +Z in the middle
    EXPECT_NEAR(equal_area_direction(1, 0.5)[0], 1, 1e-12);    // +X at the right
    EXPECT_NEAR(equal_area_direction(0.5, 1)[1], 1, 1e-12);    // +Y at the lower edge
    EXPECT_NEAR(equal_area_direction(0, 0)[2], -1, 1e-12);
}

TEST(PbrtSpectra, WhiteIsWhite) {
    const std::array<double, 4> flat{300, 0.5, 900, 0.5};
    expect_near(rgb_of_samples(flat, PbrtSpectrumUse::albedo), Spectrum{0.5f}, 2e-3f);
    const Spectrum daylight = blackbody_rgb(6504);
    EXPECT_NEAR(luminance(daylight), 1, 1e-3);
    expect_near(daylight, Spectrum{1}, 0.06f);
    const Spectrum candle = blackbody_rgb(2000);
    EXPECT_NEAR(luminance(candle), 1, 0.02);
    EXPECT_GT(candle.r, 4 * candle.b);
}

TEST(PbrtSpectra, OtherPrimariesKeepWhite) {
    for (const auto space : {PbrtColorSpace::dci_p3, PbrtColorSpace::rec2020})
        for (const auto use : {PbrtSpectrumUse::albedo, PbrtSpectrumUse::illuminant})
            expect_near(to_rec709(Spectrum{1}, space, use), Spectrum{1}, 1e-3f);
    expect_near(to_rec709(Spectrum{1}, PbrtColorSpace::aces2065, PbrtSpectrumUse::albedo), Spectrum{1},
                1e-5f);
    const Spectrum red = to_rec709({0, 1, 0}, PbrtColorSpace::rec2020, PbrtSpectrumUse::illuminant);
    EXPECT_GT(red.g, 1.1f);  // a green that Rec. 709 does not have
    const SceneData scene =
        read(std::string{"ColorSpace \"rec2020\"\nMaterial \"diffuse\" \"rgb reflectance\" [.5 .4 .4]\n"}
             + triangle);
    EXPECT_GT(scene.materials.at(0).base_color.r, 0.55f);
}

}  // namespace
}  // namespace relumine
