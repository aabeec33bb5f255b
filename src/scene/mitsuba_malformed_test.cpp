// SPDX-License-Identifier: Apache-2.0
// Damaged and hostile Mitsuba scenes: each must end in one clear line with file, line and column.
#include <gtest/gtest.h>

#include "relumine/error.hpp"
#include "relumine/scene.hpp"
#include "scene/test_files.hpp"

namespace relumine {
namespace {

using test::TempFolder;

/// What stands in <scene>, from line 2 on, and the message behind "file:".
struct Damage {
    const char* name;
    const char* text;
    const char* message;
};

void PrintTo(const Damage& damage, std::ostream* out) { *out << damage.name; }

std::string error_of(const std::string& path) {
    try {
        (void)load_scene(path);
    } catch (const Error& error) {
        return error.what();
    }
    return "";
}

constexpr Damage damages[] = {
    {"not_closed", "<shape type='sphere'>", "3:3: expected well-formed XML"},
    {"text", "hello", "1:24: expected an element, found"},
    {"unknown_tag", "<shap type='sphere'/>",
     "2:2: expected an object, a value or a reference, found <shap> (did you mean \"shape\"?)"},
    {"no_type", "<shape/>", "2:2: expected <shape type=…>, found no type"},
    {"unknown_shape", "<shape type='spere'/>", "2:2: expected a shape among"},
    {"unknown_bsdf", "<bsdf type='difuse'/>", "2:2: expected a BSDF among"},
    {"unknown_emitter", "<emitter type='pont'/>", "2:2: expected an emitter among"},
    {"unknown_sensor", "<sensor type='pinhole'/>", "2:2: expected a sensor among"},
    {"unknown_film", "<sensor type='perspective'><film type='film'/></sensor>",
     "2:29: expected a film among"},
    {"unknown_texture", "<bsdf type='diffuse'><texture type='marble' name='reflectance'/></bsdf>",
     "2:23: expected a texture among"},
    {"unknown_attribute", "<shape type='sphere' nam='a'/>", "2:2: expected <shape> with"},
    {"attribute_twice", "<shape type='sphere' type='cube'/>",
     "2:2: expected each attribute once, found \"type\" twice"},
    {"no_name", "<shape type='sphere'><float value='1'/></shape>",
     "2:23: expected <float name=…>, found no name"},
    {"name_twice",
     "<shape type='sphere'><float name='radius' value='1'/><float name='radius' value='1'/></shape>",
     "2:55: expected \"radius\" once, found it twice"},
    {"not_a_number", "<shape type='sphere'><float name='radius' value='big'/></shape>",
     "2:23: expected a number for \"radius\", found \"big\""},
    {"nan", "<shape type='sphere'><float name='radius' value='nan'/></shape>",
     "2:23: expected a number for \"radius\", found \"nan\""},
    {"infinite", "<shape type='sphere'><float name='radius' value='1e39'/></shape>",
     "2:23: expected a number for \"radius\", found \"1e39\""},
    {"two_numbers", "<shape type='sphere'><float name='radius' value='1 2'/></shape>",
     "2:23: expected a number for \"radius\", found 2 numbers"},
    {"empty_number", "<shape type='sphere'><float name='radius' value=''/></shape>",
     "2:23: expected a number for \"radius\", found 0 numbers"},
    {"string_for_number", "<shape type='sphere'><string name='radius' value='1'/></shape>",
     "2:23: expected <float> for \"radius\", found <string>"},
    {"negative_radius", "<shape type='sphere'><float name='radius' value='-1'/></shape>",
     "2:23: expected a radius above 0, found -1"},
    {"cylinder_radius", "<shape type='cylinder'><float name='radius' value='0'/></shape>",
     "2:25: expected a radius above 0, found 0"},
    {"cylinder_point", "<shape type='cylinder'><point name='p1' value='0 0 0'/></shape>",
     "2:25: expected p0 and p1 apart"},
    {"two_coordinates", "<shape type='sphere'><point name='center' x='1' y='2'/></shape>",
     "2:23: expected three numbers for \"center\", found 2"},
    {"boolean", "<shape type='sphere'><boolean name='flip_normals' value='yes'/></shape>",
     "2:23: expected true or false for \"flip_normals\", found \"yes\""},
    {"unknown_ref", "<bsdf type='diffuse' id='wall'/><shape type='sphere'><ref id='wal'/></shape>",
     "2:55: expected the id of an object, found \"wal\" (did you mean \"wall\"?)"},
    {"ref_circle", "<bsdf type='twosided' id='a'><ref id='a'/></bsdf>",
     "2:2: expected at most 16 BSDFs inside each other"},
    {"texture_circle",
     "<texture type='scale' id='t'><ref id='t'/></texture><bsdf type='diffuse'><ref name='reflectance' "
     "id='t'/></bsdf>",
     "2:2: expected at most 16 textures in a row"},
    {"id_twice", "<bsdf type='diffuse' id='a'/><bsdf type='diffuse' id='a'/>",
     "2:31: expected a new id, found \"a\", which exists"},
    {"alias_of_nothing", "<alias id='a' as='b'/>", "2:2: expected the id of an object, found \"a\""},
    {"alias_exists", "<bsdf type='diffuse' id='a'/><alias id='a' as='a'/>",
     "2:31: expected a new id, found \"a\""},
    {"alias_inside", "<shape type='sphere'><alias id='a' as='b'/></shape>",
     "2:23: expected <alias> directly in <scene>"},
    {"alias_without_as", "<alias id='a'/>", "2:2: expected <alias as=…>, found none"},
    {"default_without_value", "<default name='a'/>", "2:2: expected <default value=…>, found none"},
    {"unknown_parameter",
     "<default name='spp' value='1'/><shape type='sphere'><float name='radius' value='$sp'/></shape>",
     "2:54: expected a parameter that <default> or -D gives a value, found \"$sp\" (did you mean \"spp\"?)"},
    {"include_missing", "<include filename='no.xml'/>", "2:2: "},
    {"include_nothing", "<include/>", "2:2: expected <include filename=…>, found none"},
    {"include_outside", "<include filename='../x.xml'/>", "2:2: expected"},
    {"include_absolute", "<include filename='/etc/passwd'/>", "2:2: expected"},
    {"include_itself", "<include filename='scene.xml'/>",
     "2:2: expected at most 32 files inside each other, found more, or a circle"},
    {"path", "<path value='/data'/>", "2:2: expected files beside the scene, found <path>"},
    {"transform_step", "<shape type='cube'><transform name='to_world'><move x='1'/></transform></shape>",
     "2:48: expected a step of a transform"},
    {"in_float",
     "<shape type='sphere'><float name='radius' value='1'><float name='x' value='1'/></float></shape>",
     "2:54: expected nothing inside of <float>"},
    {"rotate_axis", "<shape type='cube'><transform name='to_world'><rotate angle='3'/></transform></shape>",
     "2:48: expected an axis that is not 0, found 0 0 0"},
    {"rotate_angle", "<shape type='cube'><transform name='to_world'><rotate x='1'/></transform></shape>",
     "2:48: expected an angle in degrees, found 0 numbers"},
    {"matrix_short",
     "<shape type='cube'><transform name='to_world'><matrix value='1 0 0'/></transform></shape>",
     "2:48: expected 16 or 9 numbers for <matrix>, found 3"},
    {"matrix_projective",
     "<shape type='cube'><transform name='to_world'><matrix value='1 0 0 0 0 1 0 0 0 0 1 0 0 0 1 "
     "1'/></transform></shape>",
     "2:48: expected an affine matrix, whose last row is 0 0 0 1, found 0 0 1 1"},
    {"look_at_itself",
     "<sensor type='perspective'><transform name='to_world'><lookat origin='0 0 0' target='0 0 0' up='0 1 "
     "0'/></transform></sensor>",
     "2:56: expected origin and target apart"},
    {"look_along_up",
     "<sensor type='perspective'><transform name='to_world'><lookat origin='0 0 0' target='0 1 0' up='0 1 "
     "0'/></transform></sensor>",
     "2:56: expected origin and target apart"},
    {"flat_camera",
     "<sensor type='perspective'><transform name='to_world'><scale y='0'/></transform></sensor>",
     "2:29: expected a sensor transform that can be inverted"},
    {"fov", "<sensor type='perspective'><float name='fov' value='180'/></sensor>",
     "2:29: expected an angle between 0 and 180 degrees, found 180"},
    {"fov_axis", "<sensor type='perspective'><string name='fov_axis' value='z'/></sensor>",
     "2:29: expected x, y, diagonal, smaller or larger for \"fov_axis\", found \"z\""},
    {"fov_and_length",
     "<sensor type='perspective'><float name='fov' value='9'/><string name='focal_length' "
     "value='50mm'/></sensor>",
     "2:58: expected either \"fov\" or \"focal_length\", found both"},
    {"focal_length", "<sensor type='perspective'><string name='focal_length' value='far'/></sensor>",
     "2:2: expected a focal length such as 50mm, found \"far\""},
    {"no_aperture", "<sensor type='thinlens'/>",
     "2:2: expected \"aperture_radius\" of \"thinlens\", found none"},
    {"no_focus", "<sensor type='thinlens'><float name='aperture_radius' value='1'/></sensor>",
     "2:2: expected a distance above 0, found 0"},
    {"film_width",
     "<sensor type='perspective'><film type='hdrfilm'><integer name='width' value='0'/></film></sensor>",
     "2:50: expected 1 to 65536 pixels, found 0"},
    {"film_fraction",
     "<sensor type='perspective'><film type='hdrfilm'><integer name='width' value='1.5'/></film></sensor>",
     "2:50: expected an integer for \"width\", found \"1.5\""},
    {"crop",
     "<sensor type='perspective'><film type='hdrfilm'><integer name='crop_width' "
     "value='900'/></film></sensor>",
     "2:50: expected a crop inside of 768 × 576 pixels"},
    {"rgb_two", "<bsdf type='diffuse'><rgb name='reflectance' value='1 2'/></bsdf>",
     "2:23: expected three numbers for the colour, found 2"},
    {"rgb_hex", "<bsdf type='diffuse'><rgb name='reflectance' value='#ff0000'/></bsdf>",
     "2:23: expected three numbers for the colour, found \"#ff0000\""},
    {"rgb_negative", "<bsdf type='diffuse'><rgb name='reflectance' value='-1 0 0'/></bsdf>",
     "2:23: expected values of at least 0 for \"reflectance\", found -1 0 0"},
    {"spectrum_pairs", "<bsdf type='diffuse'><spectrum name='reflectance' value='400:1, 700'/></bsdf>",
     "2:23: expected two or more pairs of wavelength and value, found 3 numbers"},
    {"spectrum_order", "<bsdf type='diffuse'><spectrum name='reflectance' value='400:1, 300:1'/></bsdf>",
     "2:23: expected increasing wavelengths, found 300 after 400"},
    {"spectrum_type", "<bsdf type='diffuse'><spectrum name='reflectance' type='d6'/></bsdf>",
     "2:23: expected a spectrum among"},
    {"black_body",
     "<emitter type='point'><spectrum name='intensity' type='blackbody'><float name='temperature' "
     "value='5'/></spectrum></emitter>",
     "2:24: expected a temperature of 100 to 1000000 K, found 5"},
    {"metal", "<bsdf type='conductor'><string name='material' value='Gold'/></bsdf>",
     "2:25: expected the name of a metal, found \"Gold\""},
    {"metal_and_eta",
     "<bsdf type='conductor'><string name='material' value='Au'/><float name='eta' value='1'/></bsdf>",
     "2:25: expected either \"material\" or \"eta\" and \"k\", found both"},
    {"glass", "<bsdf type='dielectric'><string name='int_ior' value='bk8'/></bsdf>",
     "2:26: expected the name of a substance, found \"bk8\" (did you mean \"bk7\"?)"},
    {"ior", "<bsdf type='dielectric'><float name='int_ior' value='0'/></bsdf>",
     "2:26: expected an index of refraction above 0, found 0"},
    {"twosided_of_nothing", "<bsdf type='twosided'/>",
     "2:2: expected one or two BSDF inside of \"twosided\", found 0"},
    {"mask_of_nothing", "<bsdf type='mask'/>", "2:2: expected one BSDF inside of \"mask\", found 0"},
    {"blend_of_one", "<bsdf type='blendbsdf'><bsdf type='diffuse'/></bsdf>",
     "2:2: expected two BSDFs in \"blendbsdf\", found 1"},
    {"normalmap_without", "<bsdf type='normalmap'><bsdf type='diffuse'/></bsdf>",
     "2:2: expected a texture called \"normalmap\", found none"},
    {"bitmap_without_file", "<bsdf type='diffuse'><texture type='bitmap' name='reflectance'/></bsdf>",
     "2:23: expected <string name=\"filename\">, found none"},
    {"bitmap_missing",
     "<bsdf type='diffuse'><texture type='bitmap' name='reflectance'><string name='filename' "
     "value='a.png'/></texture></bsdf>",
     "2:23: "},
    {"bitmap_outside",
     "<bsdf type='diffuse'><texture type='bitmap' name='reflectance'><string name='filename' "
     "value='../a.png'/></texture></bsdf>",
     "2:23: expected"},
    {"bitmap_turned",
     "<bsdf type='diffuse'><texture type='checkerboard' name='reflectance'><transform name='to_uv'><rotate "
     "z='1' angle='30'/></transform></texture></bsdf>",
     "2:71: expected a transform that scales and moves along u and v"},
    {"obj_without_file", "<shape type='obj'/>", "2:2: expected <string name=\"filename\">, found none"},
    {"obj_missing", "<shape type='obj'><string name='filename' value='a.obj'/></shape>", "2:2: "},
    {"two_bsdfs", "<shape type='sphere'><bsdf type='diffuse'/><bsdf type='diffuse'/></shape>",
     "2:2: expected one BSDF of the shape, found 2"},
    {"instance_of_nothing", "<shape type='instance'/>",
     "2:2: expected one shapegroup in \"instance\", found none"},
    {"instance_of_shape", "<shape type='sphere' id='s'/><shape type='instance'><ref id='s'/></shape>",
     "2:31: expected one shapegroup in \"instance\", found \"sphere\""},
    {"group_in_group", "<shape type='shapegroup'><shape type='shapegroup'/></shape>",
     "2:27: expected plain shapes in \"shapegroup\", found \"shapegroup\""},
    {"area_in_scene", "<emitter type='area'/>", "2:2: expected emitter \"area\" inside of a shape"},
    {"point_in_shape", "<shape type='sphere'><emitter type='point'/></shape>",
     "2:23: expected emitter \"area\" in a shape, found \"point\""},
    {"directional_area", "<shape type='sphere'><emitter type='directionalarea'/></shape>",
     "2:23: expected emitter \"area\" in a shape, found \"directionalarea\""},
    {"two_environments", "<emitter type='constant'/><emitter type='constant'/>",
     "2:28: expected one environment, found a second one"},
    {"spot_angles",
     "<emitter type='spot'><float name='cutoff_angle' value='10'/><float name='beam_width' "
     "value='20'/></emitter>",
     "2:23: expected an angle of 0 to 180 degrees"},
    {"no_direction", "<emitter type='directional'><vector name='direction' value='0 0 0'/></emitter>",
     "2:30: expected a direction that is not 0"},
    {"envmap_without_file", "<emitter type='envmap'/>",
     "2:2: expected <string name=\"filename\">, found none"},
    {"max_depth", "<integrator type='path'><integer name='max_depth' value='-2'/></integrator>",
     "2:26: expected -1 or a depth of at least 0, found -2"},
};

class MitsubaDamage : public ::testing::TestWithParam<Damage> {};

TEST_P(MitsubaDamage, IsRefusedWithItsPlace) {
    const TempFolder folder;
    const std::string path = folder.write(
        "scene.xml", "<scene version='3.0.0'>\n" + std::string{GetParam().text} + "\n</scene>\n");
    const std::string error = error_of(path);
    EXPECT_NE(error.find("scene.xml:" + std::string{GetParam().message}), std::string::npos)
        << error << "\nwanted: " << GetParam().message;
    EXPECT_EQ(error.find('\n'), std::string::npos);
}

INSTANTIATE_TEST_SUITE_P(All, MitsubaDamage, ::testing::ValuesIn(damages),
                         [](const auto& test) { return std::string{test.param.name}; });

TEST(MitsubaDamage, OfTheWholeFile) {
    const TempFolder folder;
    const auto error = [&](const std::string& text) { return error_of(folder.write("scene.xml", text)); };
    const auto holds = [](const std::string& text, const std::string& part) {
        EXPECT_NE(text.find(part), std::string::npos) << text;
    };
    holds(error(""), "1:1: expected well-formed XML");
    holds(error("<a/>"), "1:2: expected <scene> around everything");
    holds(error("<scene/>"), "expected <scene version=\"3.0.0\">, found no version");
    holds(error("<scene version='0.6.0'/>"), "expected a scene of version 2 or 3");
    holds(error("<scene version='3.0.0'/><scene version='3.0.0'/>"), "expected one <scene>");
    holds(error("<!DOCTYPE scene [<!ENTITY a SYSTEM '/etc/passwd'>]><scene version='3.0.0'/>"),
          "expected XML without entities");
    std::string deep = "<scene version='3.0.0'>";
    for (int i = 0; i < 70; ++i) deep += "<bsdf type='twosided'>";
    for (int i = 0; i < 70; ++i) deep += "</bsdf>";
    holds(error(deep + "</scene>"), "expected at most 64 elements in a row");
}

}  // namespace
}  // namespace relumine
