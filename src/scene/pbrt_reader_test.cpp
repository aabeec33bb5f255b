// SPDX-License-Identifier: Apache-2.0
// What pbrt scenes mean: transforms, sides, shapes, materials, textures, lights and spectra.
#include <gtest/gtest.h>

#include "base/equal_area.hpp"
#include "image/byte_image.hpp"
#include "scene/finish_scene.hpp"
#include "scene/pbrt_spectrum.hpp"
#include "scene/pbrt_transform.hpp"
#include "scene/readers.hpp"
#include "scene/test_files.hpp"

namespace relumine {
namespace {

using test::TempFolder;

constexpr const char* triangle =
    "Shape \"trianglemesh\" \"point3 P\" [0 0 0  1 0 0  0 1 0] \"integer indices\" [0 1 2]\n";

SceneData read(const TempFolder& folder, const std::string& world, const std::string& options = "") {
    return read_pbrt(folder.write("scene.pbrt", options + "\nWorldBegin\n" + world));
}
SceneData read(const std::string& world, const std::string& options = "") {
    const TempFolder folder;
    return read(folder, world, options);
}
SceneData finished(const std::string& world) { return finish_scene(read(world)); }

bool warns(const SceneData& scene, const std::string& text) {
    return std::ranges::any_of(
        scene.warnings, [&](const std::string& warning) { return warning.find(text) != warning.npos; });
}

void expect_near(Vec3 a, Vec3 b, float tolerance = 1e-5f) {
    EXPECT_NEAR(a.x, b.x, tolerance);
    EXPECT_NEAR(a.y, b.y, tolerance);
    EXPECT_NEAR(a.z, b.z, tolerance);
}
void expect_near(Spectrum a, Spectrum b, float tolerance = 1e-5f) {
    expect_near(Vec3{a.r, a.g, a.b}, Vec3{b.r, b.g, b.b}, tolerance);
}

/// The unit normal on the side from which the triangle is counter-clockwise: where our emission goes.
Vec3 front(const SceneData& scene, std::size_t mesh = 0, std::size_t index = 0) {
    const Mesh& m = scene.meshes[mesh];
    const auto [a, b, c] = m.triangles[index].vertex;
    return normalize(cross(m.positions[b] - m.positions[a], m.positions[c] - m.positions[a]));
}

TEST(PbrtTransforms, LaterOnesActFirst) {
    const SceneData scene = finished(std::string{"Translate 1 0 0 Rotate 90 0 0 1\n"} + triangle);
    expect_near(scene.meshes[0].positions[1], {1, 1, 0});
    const SceneData other = finished(std::string{"Rotate 90 0 0 1 Translate 1 0 0\n"} + triangle);
    expect_near(other.meshes[0].positions[1], {0, 2, 0});
}

TEST(PbrtTransforms, MatricesComeColumnByColumn) {
    const SceneData scene =
        finished(std::string{"Scale 9 9 9 Transform [1 0 0 0  0 1 0 0  0 0 1 0  5 6 7 1]\n"} + triangle);
    expect_near(scene.meshes[0].positions[1], {6, 6, 7});
    const SceneData both = finished(
        std::string{"Scale 2 2 2 ConcatTransform [1 0 0 0  0 1 0 0  0 0 1 0  5 6 7 1]\n"} + triangle);
    expect_near(both.meshes[0].positions[1], {12, 12, 14});
}

TEST(PbrtTransforms, AttributesRestoreAndNamesReturn) {
    const SceneData scene = finished(std::string{"Translate 1 0 0 CoordinateSystem \"a\"\n"
                                                 "AttributeBegin Translate 5 5 5 AttributeEnd\n"}
                                     + triangle + "Identity CoordSysTransform \"a\"\n" + triangle
                                     + "CoordSysTransform \"world\"\n" + triangle);
    expect_near(scene.meshes[0].positions[0], {1, 0, 0});
    expect_near(scene.meshes[1].positions[0], {1, 0, 0});
    expect_near(scene.meshes[2].positions[0], {0, 0, 0});
}

TEST(PbrtTransforms, InverseUndoes) {
    const Transform t = pbrt_translate({1, 2, 3}) * pbrt_rotate(40, {1, 2, 0}) * pbrt_scale({2, -3, 0.5});
    const Transform product = t * *inverse(t);
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 4; ++j) EXPECT_NEAR(product.m[i][j], i == j ? 1 : 0, 1e-12);
    EXPECT_FALSE(inverse(pbrt_scale({1, 0, 1})));
}

TEST(PbrtTransforms, InstancesStandOnTheirDefinition) {
    const SceneData scene = finished(std::string{"Translate 0 0 1 ObjectBegin \"a\" Scale 2 2 2\n"} + triangle
                                     + "ObjectEnd Identity\n"
                                       "Translate 10 0 0 ObjectInstance \"a\" Translate 10 0 0 ObjectInstance \"a\"");
    ASSERT_EQ(scene.instances.size(), 2u);
    ASSERT_EQ(scene.meshes.size(), 1u);
    expect_near(scene.instances[0].world_from_object.point(scene.meshes[0].positions[1]), {12, 0, 1});
    expect_near(scene.instances[1].world_from_object.point(scene.meshes[0].positions[1]), {22, 0, 1});
}

TEST(PbrtFilesTogether, IncludeSharesTheStateAndImportDoesNot) {
    const TempFolder folder;
    (void)folder.write("parts/move.pbrt", "Translate 1 0 0\nMaterial \"conductor\"\n");
    const SceneData included =
        finish_scene(read(folder, std::string{"Include \"parts/move.pbrt\"\n"} + triangle));
    expect_near(included.meshes[0].positions[0], {1, 0, 0});
    EXPECT_EQ(included.materials[0].metallic, 1);
    const SceneData imported =
        finish_scene(read(folder, std::string{"Import \"parts/move.pbrt\"\n"} + triangle));
    expect_near(imported.meshes[0].positions[0], {0, 0, 0});
    EXPECT_EQ(imported.materials[0].metallic, 0);
}

TEST(PbrtFilesTogether, NamesBesideTheIncludingFileAreFound) {
    const TempFolder folder;
    (void)folder.write("parts/inner.pbrt", triangle);
    (void)folder.write("parts/outer.pbrt", "Include \"inner.pbrt\"");
    EXPECT_EQ(read(folder, "Include \"parts/outer.pbrt\"").meshes.size(), 1u);
}

TEST(PbrtSides, FollowPbrtsNormals) {
    const auto lit = [](const std::string& before, const std::string& after = "") {
        return front(finished("AreaLightSource \"diffuse\" " + before + '\n' + triangle + after));
    };
    expect_near(lit(""), {0, 0, 1});
    expect_near(lit("ReverseOrientation"), {0, 0, -1});
    expect_near(lit("Scale -1 1 1"), {0, 0, 1});  // pbrt flips the algebraic normal where handedness swaps
    expect_near(lit("ReverseOrientation Scale -1 1 1"), {0, 0, -1});
}

TEST(PbrtSides, VertexNormalsDecide) {
    const std::string mesh =
        "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"normal N\" [0 0 -1 0 0 -1 0 0 -1]";
    expect_near(front(finished(mesh)), {0, 0, -1});
    expect_near(front(finished("ReverseOrientation " + mesh)), {0, 0, 1});
}

TEST(PbrtSides, QuadricsFaceOutwards) {
    for (const char* shape : {"sphere", "cylinder"}) {
        const SceneData scene = finished(std::string{"Shape \""} + shape + "\"");
        for (std::size_t i = 0; i < scene.meshes[0].triangles.size(); i += 97) {
            const Vec3 p = scene.meshes[0].positions[scene.meshes[0].triangles[i].vertex[0]];
            EXPECT_GT(dot(front(scene, 0, i), Vec3{p.x, p.y, 0.5f * p.z}), 0) << shape << i;
        }
    }
    expect_near(front(finished("Shape \"disk\"")), {0, 0, 1});
    expect_near(front(finished("ReverseOrientation Shape \"disk\"")), {0, 0, -1});
    expect_near(front(finished("Shape \"bilinearmesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0 1 1 0]")), {0, 0, 1});
}

double area(const SceneData& scene) {
    double sum = 0;
    for (const Triangle& t : scene.meshes[0].triangles) {
        const auto& p = scene.meshes[0].positions;
        sum += 0.5 * double{length(cross(p[t.vertex[1]] - p[t.vertex[0]], p[t.vertex[2]] - p[t.vertex[0]]))};
    }
    return sum;
}

TEST(PbrtShapes, HaveTheirAreas) {
    constexpr double pi_d = 3.14159265358979;
    EXPECT_NEAR(area(finished("Shape \"sphere\" \"float radius\" 2")), 16 * pi_d, 16 * pi_d * 3e-4);
    EXPECT_NEAR(area(finished("Shape \"sphere\" \"float zmin\" 0")), 2 * pi_d, 2 * pi_d * 3e-4);
    EXPECT_NEAR(area(finished("Shape \"sphere\" \"float phimax\" 90")), pi_d, pi_d * 3e-4);
    EXPECT_NEAR(area(finished("Shape \"disk\" \"float radius\" 2 \"float innerradius\" 1")), 3 * pi_d, 3e-3);
    EXPECT_NEAR(area(finished("Shape \"cylinder\" \"float zmax\" 2")), 6 * pi_d, 6e-3);
    EXPECT_NEAR(area(finished("Shape \"bilinearmesh\" \"point3 P\" [0 0 0 2 0 0 0 3 0 2 3 0]")), 6, 1e-5);
}

TEST(PbrtShapes, CoordinatesGrowAsInPbrt) {
    const SceneData scene = read("Shape \"sphere\"");
    for (std::size_t i = 0; i < scene.meshes[0].positions.size(); i += 111) {
        const Vec3 p = scene.meshes[0].positions[i];
        const Vec2 uv = scene.meshes[0].uvs[0][i];
        const float v = 1 - uv.y;  // 0 at the bottom
        EXPECT_NEAR(p.z, -std::cos(pi * v), 1e-5f);
        if (v > 0.01f && v < 0.99f) {
            EXPECT_NEAR(p.x, std::sin(pi * v) * std::cos(2 * pi * uv.x), 1e-5f);
            EXPECT_NEAR(p.y, std::sin(pi * v) * std::sin(2 * pi * uv.x), 1e-5f);
        }
    }
}

TEST(PbrtShapes, SubdivisionOfAnIcosahedronIsRound) {
    const SceneData scene = finished(
        "Shape \"loopsubdiv\" \"integer levels\" 3 \"point3 P\" [0 1 1.618 0 -1 1.618 0 1 -1.618 0 -1 -1.618 "
        "1 1.618 0 -1 1.618 0 1 -1.618 0 -1 -1.618 0 1.618 0 1 -1.618 0 1 1.618 0 -1 -1.618 0 -1] "
        "\"integer indices\" [0 1 8 0 8 4 0 4 5 0 5 9 0 9 1 3 2 10 3 10 6 3 6 7 3 7 11 3 11 2 "
        "1 6 8 8 10 4 4 2 5 5 11 9 9 7 1 10 8 6 2 4 10 11 5 2 7 9 11 6 1 7]");
    const Mesh& mesh = scene.meshes[0];
    EXPECT_EQ(mesh.triangles.size(), 20u * 64u);
    float least = infinity, most = 0;
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        least = std::min(least, length(mesh.positions[i]));
        most = std::max(most, length(mesh.positions[i]));
        EXPECT_GT(std::abs(dot(mesh.normals[i], normalize(mesh.positions[i]))), 0.99f);
    }
    EXPECT_GT(least / most, 0.97f);
}

TEST(PbrtShapes, ReadsPlyPackedOrNot) {
    const TempFolder folder;
    (void)folder.write(
        "a.ply",
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty "
        "float z\nproperty float u\nproperty float v\nelement face 1\nproperty list uchar int "
        "vertex_indices\nend_header\n0 0 0 0 0\n1 0 0 1 0\n1 1 0 1 1\n0 1 0 0 1\n4 0 1 2 3\n");
    const SceneData scene = read(folder, "Shape \"plymesh\" \"string filename\" \"a.ply\"");
    ASSERT_EQ(scene.meshes.size(), 1u);
    EXPECT_EQ(scene.meshes[0].triangles.size(), 2u);
    EXPECT_EQ(scene.meshes[0].uvs[0][0], (Vec2{0, 1}));
    ASSERT_EQ(std::system(("gzip -k " + folder.path("a.ply")).c_str()), 0);
    EXPECT_EQ(read(folder, "Shape \"plymesh\" \"string filename\" \"a.ply.gz\"").meshes[0].triangles.size(),
              2u);
}

TEST(PbrtShapes, CurvesAreLeftOutWithAWarning) {
    const SceneData scene =
        read(std::string{triangle} + "Shape \"curve\" \"point3 P\" [0 0 0 1 0 0 2 0 0 3 0 0]");
    EXPECT_EQ(scene.meshes.size(), 1u);
    EXPECT_TRUE(warns(scene, "scene.pbrt:4:1: shape \"curve\" is not supported"));
}

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
    EXPECT_FLOAT_EQ(
        material("Material \"conductor\" \"float uroughness\" .04 \"float vroughness\" .16").roughness,
        std::sqrt(std::sqrt(.08f)));
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
    EXPECT_EQ(mesh.uvs[1].at(1), (Vec2{2, 1}));  // s = 2 x; t = z of the texture's space = 0
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
