// SPDX-License-Identifier: Apache-2.0
// Mitsuba scenes: parameters, references, transforms, shapes, colours, materials, lights.
#include <gtest/gtest.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>

#include "relumine/error.hpp"
#include "scene/finish_scene.hpp"
#include "scene/readers.hpp"
#include "scene/test_files.hpp"

namespace relumine {
namespace {

using test::TempFolder;

SceneData read(const std::string& text, const std::map<std::string, std::string>& definitions = {}) {
    const TempFolder folder;
    SceneOptions options;
    options.definitions = definitions;
    return read_mitsuba(folder.write("scene.xml", "<scene version='3.0.0'>" + text + "</scene>"), options);
}

const Material& material_of(const SceneData& scene) {
    return scene.materials.at(index(scene.meshes.at(0).material));
}
SceneData with_bsdf(const std::string& bsdf) { return read("<shape type='sphere'>" + bsdf + "</shape>"); }

bool warns(const SceneData& scene, const std::string& part) {
    return std::ranges::any_of(scene.warnings, [&](const std::string& w) { return w.find(part) != w.npos; });
}

void expect_near(Spectrum a, Spectrum b, float tolerance) {
    EXPECT_NEAR(a.r, b.r, tolerance);
    EXPECT_NEAR(a.g, b.g, tolerance);
    EXPECT_NEAR(a.b, b.b, tolerance);
}
void expect_near(Vec3 a, Vec3 b, float tolerance = 1e-5f) {
    EXPECT_NEAR(a.x, b.x, tolerance);
    EXPECT_NEAR(a.y, b.y, tolerance);
    EXPECT_NEAR(a.z, b.z, tolerance);
}

TEST(Mitsuba, ParametersHaveDefaultsThatDefinitionsReplace) {
    const std::string text =
        "<default name='r' value='2'/><emitter type='point'><point name='position' value='$r 0 "
        "-$r'/></emitter>";
    expect_near(read(text).point_lights.at(0).position, {2, 0, -2});
    expect_near(read(text, {{"r", "5"}}).point_lights.at(0).position, {5, 0, -5});
    EXPECT_THROW((void)read(text, {{"radius", "5"}}), SceneError);
}

TEST(Mitsuba, IncludesAndAliasesAreFollowed) {
    const TempFolder folder;
    folder.write("parts/bsdf.xml",
                 "<scene version='3.0.0'><bsdf type='diffuse' id='a'><rgb name='reflectance' value='.1 .2 "
                 ".3'/></bsdf></scene>");
    const std::string path =
        folder.write("scene.xml",
                     "<scene version='3.0.0'><include filename='parts/bsdf.xml'/><alias id='a' as='b'/>"
                     "<shape type='sphere'><ref id='b'/></shape></scene>");
    expect_near(material_of(read_mitsuba(path)).base_color, {.1f, .2f, .3f}, 1e-6f);
}

TEST(Mitsuba, TransformsActInOrder) {  // move, then turn, then enlarge
    const SceneData scene = read(
        "<emitter type='point'><transform name='to_world'><translate x='1'/><rotate z='1' angle='90'/>"
        "<scale value='2'/></transform></emitter>");
    expect_near(scene.point_lights.at(0).position, {0, 2, 0});
}

TEST(Mitsuba, SensorsLookAlongZWithXToTheLeft) {
    const SceneData scene = read("<sensor type='perspective'/>");
    const Transform t = scene.cameras.at(0).world_from_camera;
    expect_near(t.vector({0, 0, -1}), {0, 0, 1});  // ahead
    expect_near(t.vector({1, 0, 0}), {-1, 0, 0});  // the picture's right
    expect_near(t.vector({0, 1, 0}), {0, 1, 0});
    const Transform looks =
        read(
            "<sensor type='perspective'><transform name='to_world'><lookat origin='0 0 5' "
            "target='0 0 0' up='0 1 0'/></transform></sensor>")
            .cameras.at(0)
            .world_from_camera;
    expect_near(looks.vector({1, 0, 0}), {1, 0, 0});  // seen from +Z, +X is to the right
    expect_near(looks.vector({0, 0, -1}), {0, 0, -1});
    EXPECT_GT(determinant(looks), 0);
}

TEST(Mitsuba, FieldOfViewIsThatOfTheAxis) {
    const auto extent = [](const std::string& axis) {
        return read("<sensor type='perspective'><float name='fov' value='90'/><string name='fov_axis' value='" + axis
                    + "'/><film type='hdrfilm'><integer name='width' value='200'/><integer name='height' "
                      "value='100'/></film></sensor>")
            .cameras.at(0)
            .vertical_extent;
    };
    EXPECT_NEAR(std::tan(extent("x") / 2), 0.5, 1e-9);
    EXPECT_NEAR(std::tan(extent("y") / 2), 1, 1e-9);
    EXPECT_NEAR(std::tan(extent("smaller") / 2), 1, 1e-9);
    EXPECT_NEAR(std::tan(extent("larger") / 2), 0.5, 1e-9);
    EXPECT_NEAR(std::tan(extent("diagonal") / 2), 1 / std::sqrt(5.0), 1e-9);
    EXPECT_NEAR(read("<sensor type='orthographic'/>").cameras.at(0).vertical_extent, 1.5, 1e-9);
}

TEST(Mitsuba, ShapesFaceOutwards) {
    for (const char* type : {"sphere", "cube", "cylinder", "rectangle", "disk"}) {
        SceneData scene = read("<shape type='" + std::string{type} + "'/>");
        const Mesh& mesh = scene.meshes.at(0);
        for (const Triangle& t : mesh.triangles) {
            const Vec3 a = mesh.positions[t.vertex[0]];
            const Vec3 n = cross(mesh.positions[t.vertex[1]] - a, mesh.positions[t.vertex[2]] - a);
            EXPECT_GT(
                dot(n, mesh.normals[t.vertex[0]] + mesh.normals[t.vertex[1]] + mesh.normals[t.vertex[2]]), 0)
                << type;
        }
    }
}

TEST(Mitsuba, CylindersRunFromP0ToP1) {
    const SceneData scene = finish_scene(
        read("<shape type='cylinder'><point name='p0' value='1 1 0'/><point name='p1' value='1 3 0'/>"
             "<float name='radius' value='.5'/></shape>"));
    expect_near(scene.bounds.lower, {.5f, 1, -.5f}, 1e-4f);
    expect_near(scene.bounds.upper, {1.5f, 3, .5f}, 1e-4f);
}

TEST(Mitsuba, InstancesMoveGroups) {
    const SceneData scene =
        finish_scene(read("<shape type='shapegroup' id='g'><shape type='cube'/></shape>"
                          "<shape type='instance'><ref id='g'/><transform name='to_world'><translate "
                          "x='5'/></transform></shape>"
                          "<shape type='instance'><ref id='g'/><transform name='to_world'><translate "
                          "x='-5'/></transform></shape>"));
    EXPECT_EQ(scene.meshes.size(), 1u);
    EXPECT_EQ(scene.instances.size(), 2u);
    expect_near(scene.bounds.lower, {-6, -1, -1});
    expect_near(scene.bounds.upper, {6, 1, 1});
}

/// A `.serialized` file of two meshes: one triangle each, at z = 0 and z = 7.
std::string serialized(std::uint16_t version) {
    std::string file, offsets;
    for (const float z : {0.0f, 7.0f}) {
        const std::size_t at = file.size();
        std::string body = test::bytes_of(std::vector<std::uint32_t>{0x1000 | 0x2});
        if (version == 4) body += std::string("name") + '\0';
        body += test::bytes_of(std::vector<std::uint64_t>{3, 1});
        body += test::bytes_of(std::vector<float>{0, 0, z, 1, 0, z, 0, 1, z, 0, 0, 1, 0, 0, 1});
        body += test::bytes_of(std::vector<std::uint32_t>{0, 1, 2});
        std::string packed(compressBound(body.size()), '\0');
        uLongf size = packed.size();
        compress(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<const Bytef*>(body.data()),
                 body.size());
        file += test::bytes_of(std::vector<std::uint16_t>{0x041C, version}) + packed.substr(0, size);
        offsets += version == 4 ? test::bytes_of(std::vector<std::uint64_t>{at})
                                : test::bytes_of(std::vector<std::uint32_t>{static_cast<std::uint32_t>(at)});
    }
    return file + offsets + test::bytes_of(std::vector<std::uint32_t>{2});
}

TEST(Mitsuba, SerializedMeshesOfBothVersions) {
    const TempFolder folder;
    for (const std::uint16_t version : {std::uint16_t{3}, std::uint16_t{4}}) {
        const std::string whole = serialized(version);
        folder.write("a.serialized", whole);
        const std::string path = folder.write(
            "scene.xml",
            "<scene version='3.0.0'><shape type='serialized'><string name='filename' value='a.serialized'/>"
            "<integer name='shape_index' value='1'/></shape></scene>");
        const SceneData scene = read_mitsuba(path);
        expect_near(scene.meshes.at(0).positions.at(1), {1, 0, 7});
        EXPECT_EQ(scene.meshes.at(0).uvs[0].at(1).x, 1);
        for (std::size_t size = 0; size < whole.size();
             size += 7) {  // cut short: refused, whatever the place
            folder.write("a.serialized", whole.substr(0, size));
            EXPECT_THROW((void)read_mitsuba(path), SceneError) << size;
        }
    }
}

TEST(Mitsuba, ConstantSpectraAreGreyAndLightsHaveTheColorOfIlluminantE) {
    const SceneData scene = read(
        "<shape type='sphere'><bsdf type='diffuse'><spectrum name='reflectance' value='.3'/></bsdf></shape>"
        "<emitter type='point'><spectrum name='intensity' value='2'/></emitter>");
    expect_near(material_of(scene).base_color, Spectrum{.3f}, 1e-6f);
    expect_near(scene.point_lights.at(0).intensity, {2.4096f, 1.8966f, 1.8178f}, 4e-3f);  // Mitsuba's own
}

TEST(Mitsuba, MetalsReflectAtNormalIncidenceAsTheyDo) {
    expect_near(material_of(with_bsdf("<bsdf type='conductor'><rgb name='eta' value='.2 .9 1.1'/><rgb "
                                      "name='k' value='3.9 2.5 2.1'/></bsdf>"))
                    .base_color,
                {.9508f, .6349f, .5019f}, 2e-3f);
    expect_near(material_of(with_bsdf("<bsdf type='conductor'/>")).base_color, Spectrum{1}, 1e-6f);
    const SceneData gold = with_bsdf(
        "<bsdf type='roughconductor'><string name='material' value='Au'/><string name='distribution' "
        "value='ggx'/><float name='alpha' value='.25'/></bsdf>");
    expect_near(material_of(gold).base_color, {1, .782f, .3435f}, 1e-3f);
    EXPECT_NEAR(material_of(gold).roughness, 0.5f, 1e-6f);
    EXPECT_EQ(material_of(gold).metallic, 1);
}

TEST(Mitsuba, RoughnessMayDifferAlongUAndV) {
    for (const char* kind : {"roughconductor", "roughdielectric"}) {
        const SceneData scene =
            with_bsdf("<bsdf type='" + std::string{kind}
                      + "'><string name='distribution' value='ggx'/><float name='alpha_u' value='.1'/><float "
                        "name='alpha_v' value='.4'/></bsdf>");
        const Material& m = material_of(scene);
        EXPECT_NEAR(sqr(m.roughness), .1f, 1e-6f);
        EXPECT_NEAR(lerp(.1f, 1.0f, sqr(m.anisotropy)), .4f, 1e-6f);
        EXPECT_FLOAT_EQ(m.anisotropy_rotation, pi / 2);
        for (const std::string& w : scene.warnings) EXPECT_EQ(w.find("alpha"), w.npos) << w;
    }
    const Material u =
        material_of(with_bsdf("<bsdf type='roughconductor'><float name='alpha_u' value='.5'/><float "
                              "name='alpha_v' value='.2'/></bsdf>"));
    EXPECT_NEAR(lerp(sqr(u.roughness), 1.0f, sqr(u.anisotropy)), .5f, 1e-6f);
    EXPECT_EQ(u.anisotropy_rotation, 0);
    EXPECT_FALSE(
        is_anisotropic(material_of(with_bsdf("<bsdf type='roughconductor'><float name='alpha_u' "
                                             "value='.2'/><float name='alpha_v' value='.2'/></bsdf>"))));
    const Material principled =
        material_of(with_bsdf("<bsdf type='principled'><float name='roughness' value='.5'/><float "
                              "name='anisotropic' value='.75'/></bsdf>"));
    const float aspect = std::sqrt(1 - .9f * .75f);
    EXPECT_NEAR(sqr(principled.roughness), .25f * aspect, 1e-6f);
    EXPECT_NEAR(lerp(sqr(principled.roughness), 1.0f, sqr(principled.anisotropy)), .25f / aspect, 1e-6f);
}

TEST(Mitsuba, GlassHasARelativeIndex) {
    const SceneData glass = with_bsdf("<bsdf type='dielectric'/>");
    EXPECT_NEAR(material_of(glass).ior, 1.5046 / 1.000277, 1e-5);
    EXPECT_TRUE(material_of(glass).solid);
    const SceneData bubble = with_bsdf(
        "<bsdf type='dielectric'><float name='int_ior' value='1'/><float name='ext_ior' "
        "value='1.5'/></bsdf>");
    EXPECT_NEAR(material_of(bubble).ior, 1.5, 1e-5);  // seen from the other side
    EXPECT_LT(dot(bubble.meshes[0].positions[500], bubble.meshes[0].normals[500]), 0);
    EXPECT_FALSE(material_of(with_bsdf("<bsdf type='thindielectric'/>")).solid);
}

TEST(Mitsuba, TexturesHaveTheirFirstRowAtVZero) {
    const SceneData scene = read(
        "<shape type='rectangle'><bsdf type='diffuse'><texture type='checkerboard' name='reflectance'>"
        "<float name='color0' value='1'/><float name='color1' value='0'/></texture></bsdf></shape>");
    const Material& m = material_of(scene);
    ASSERT_TRUE(m.base_color_texture.has_value());
    const ByteImage& image = scene.images.at(index(m.base_color_texture->image));
    const auto& t = m.base_color_texture->uv_transform;
    const auto at = [&](float u, float v) {
        const float s = t[0] * u + t[1] * v + t[2], w = t[3] * u + t[4] * v + t[5];
        const int x = static_cast<int>(std::floor((s - std::floor(s)) * 2)),
                  y = static_cast<int>(std::floor((w - std::floor(w)) * 2));
        return image.rgba16[4 * static_cast<std::size_t>(2 * y + x)] > 30000;
    };
    EXPECT_TRUE(at(.1f, .1f));  // color0 where both are below or above a half, as Mitsuba has it
    EXPECT_FALSE(at(.9f, .1f));
    EXPECT_FALSE(at(.1f, .9f));
    EXPECT_TRUE(at(.9f, .9f));
}

TEST(Mitsuba, WarnsOfWhatIsUnknownOrApproximate) {
    EXPECT_TRUE(
        warns(with_bsdf("<bsdf type='diffuse'><float name='reflectanc' value='1'/></bsdf>"),
              "\"reflectanc\" of \"diffuse\" is unknown and was not read (did you mean \"reflectance\"?)"));
    EXPECT_TRUE(warns(with_bsdf("<bsdf type='principled'/>"), "scene.xml:1:"));
    EXPECT_TRUE(warns(with_bsdf("<bsdf type='roughconductor'/>"),
                      "\"beckmann\" of \"roughconductor\" is read as \"ggx\""));
    EXPECT_TRUE(warns(read("<integrator type='path'><integer name='max_depth' value='6'/></integrator>"),
                      "--max-depth 5 renders the same"));
}

TEST(Mitsuba, BlendsOfDiffuseAndNothingAreExact) {
    const SceneData blend = with_bsdf(
        "<bsdf type='blendbsdf'><float name='weight' value='.25'/><bsdf type='diffuse'><rgb "
        "name='reflectance' value='0 .4 .8'/></bsdf>"
        "<bsdf type='diffuse'><rgb name='reflectance' value='.8 .4 0'/></bsdf></bsdf>");
    expect_near(material_of(blend).base_color, {.2f, .4f, .6f}, 1e-5f);
    const SceneData cut =
        with_bsdf("<bsdf type='mask'><float name='opacity' value='.25'/><bsdf type='diffuse'/></bsdf>");
    EXPECT_NEAR(material_of(cut).base_alpha, .25f, 1e-6f);
    EXPECT_TRUE(with_bsdf("<bsdf type='null'/>").meshes.empty());
}

}  // namespace
}  // namespace relumine
