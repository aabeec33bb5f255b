// SPDX-License-Identifier: Apache-2.0
// Damaged and hostile pbrt scenes: each must end in one clear line with file, line and column.
#include <gtest/gtest.h>

#include "relumine/error.hpp"
#include "relumine/scene.hpp"
#include "scene/test_files.hpp"

namespace relumine {
namespace {

using test::TempFolder;

/// A scene and its message behind "file:".
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
    {"empty", "", "1:1: expected WorldBegin, found the end of the file"},
    {"unknown_directive", "WorldBegin\nShap \"sphere\"",
     "2:1: expected a directive, found \"Shap\" (did you mean \"Shape\"?)"},
    {"string_as_directive", "WorldBegin\n \"sphere\"",
     "2:2: expected a directive, found the string \"sphere\""},
    {"bracket_as_directive", "WorldBegin ]", "1:12: expected a directive, found ]"},
    {"v3_world_end", "WorldBegin\nWorldEnd", "2:1: expected a directive of pbrt-v4, found \"WorldEnd\""},
    {"open_string", "WorldBegin\nShape \"sphere", "2:7: expected a string that ends"},
    {"type_without_quotes", "WorldBegin\nShape sphere",
     "2:7: expected a type or name for Shape in quotation marks, found \"sphere\""},
    {"no_type", "WorldBegin\nShape", "2:6: expected a type or name for Shape, found the end of the file"},
    {"unknown_shape", "WorldBegin\nShape \"spere\"", "2:1: expected a shape among"},
    {"shape_before_world", "Shape \"sphere\"",
     "1:1: expected WorldBegin before the scene's description, found Shape"},
    {"camera_in_world", "WorldBegin\nCamera \"perspective\"",
     "2:1: expected the scene's description after WorldBegin, found Camera"},
    {"two_worlds", "WorldBegin WorldBegin",
     "1:12: expected the scene's description after WorldBegin, found WorldBegin"},
    {"attribute_not_closed", "WorldBegin\nAttributeBegin\nShape \"sphere\"\n",
     "4:1: expected AttributeEnd for the one at"},
    {"attribute_not_opened", "WorldBegin\nAttributeEnd",
     "2:1: expected AttributeBegin before AttributeEnd, found none"},
    {"object_closed_as_attribute", "WorldBegin\nObjectBegin \"a\"\nAttributeEnd",
     "3:1: expected ObjectEnd for the ObjectBegin at"},
    {"attribute_closed_as_object", "WorldBegin ObjectBegin \"a\" AttributeBegin ObjectEnd",
     "1:43: expected AttributeEnd for the AttributeBegin at"},
    {"object_not_opened", "WorldBegin ObjectEnd", "1:12: expected ObjectBegin before ObjectEnd, found none"},
    {"object_in_object", "WorldBegin ObjectBegin \"a\" ObjectBegin \"b\"",
     "1:28: expected no ObjectBegin inside of another"},
    {"object_twice", "WorldBegin ObjectBegin \"a\" ObjectEnd ObjectBegin \"a\"",
     "1:38: expected a new name for the object, found \"a\", which exists"},
    {"instance_in_object", "WorldBegin ObjectBegin \"a\" ObjectInstance \"a\"",
     "1:43: expected no ObjectInstance inside of an object"},
    {"instance_of_nothing",
     "WorldBegin ObjectBegin \"tree\" Shape \"sphere\" ObjectEnd ObjectInstance \"treee\"",
     "1:71: expected the name of an object, found \"treee\" (did you mean \"tree\"?)"},
    {"number_missing", "Translate 1 2", "1:14: expected a number, found the end of the file"},
    {"not_a_number", "Translate 1 x 2", "1:13: expected a number, found \"x\""},
    {"number_with_tail", "Translate 1 2,5 2", "1:13: expected a number, found \"2,5\""},
    {"nan", "Translate nan 0 0", "1:11: expected a finite number, found \"nan\""},
    {"infinite", "Translate 0 inf 0", "1:13: expected a finite number, found \"inf\""},
    {"too_large_for_float", "Translate 0 1e39 0", "1:13: expected a finite number, found \"1e39\""},
    {"matrix_without_bracket", "Transform 1 0 0 0", "1:11: expected [ and 16 numbers, found \"1\""},
    {"matrix_too_short", "Transform [1 0 0 0]", "1:19: expected a number, found ]"},
    {"matrix_too_long", "Transform [1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1 7]", "1:44: expected ] after 16 numbers"},
    {"projective_matrix", "Transform [1 0 0 1 0 1 0 0 0 0 1 0 0 0 0 1]", "1:11: expected an affine matrix"},
    {"look_at_itself", "LookAt 0 0 0 0 0 0 0 1 0", "1:1: expected two different points"},
    {"look_along_up", "LookAt 0 0 0 0 1 0 0 1 0", "1:1: expected two different points"},
    {"rotate_about_nothing", "Rotate 30 0 0 0", "1:1: expected an axis that is not 0, found 0 0 0"},
    {"flat_camera", "Scale 1 0 1\nCamera \"perspective\"",
     "2:1: expected a camera transform that can be inverted"},
    {"unknown_coordinate_system", "WorldBegin\nCoordSysTransform \"wrld\"",
     "2:19: expected a coordinate system that was named before, found \"wrld\" (did you mean \"world\"?)"},
    {"active_transform", "ActiveTransform Al", "1:17: expected All, StartTime or EndTime, found \"Al\""},
    {"color_space", "ColorSpace \"rec709\"",
     "1:12: expected the colour space srgb, dci-p3, rec2020 or aces2065-1"},
    {"attribute_target", "WorldBegin Attribute \"shapes\" \"float radius\" 2",
     "1:12: expected the attribute target"},
    {"parameter_without_type", "WorldBegin\nShape \"sphere\" \"radius\" 1",
     "2:16: expected \"type name\" of a parameter"},
    {"parameter_without_value", "WorldBegin\nShape \"sphere\" \"float radius\"",
     "2:30: expected a value for \"radius\", found the end of the file"},
    {"empty_value", "WorldBegin\nShape \"sphere\" \"float radius\" []",
     "2:16: expected float values for \"radius\", found none"},
    {"bracket_not_closed", "WorldBegin\nShape \"sphere\" \"float radius\" [1",
     "2:33: expected ], found the end of the file"},
    {"unknown_type", "WorldBegin\nShape \"sphere\" \"flot radius\" 1", "2:16: expected the type"},
    {"v3_type", "WorldBegin\nShape \"trianglemesh\" \"point P\" [0 0 0]",
     "2:22: expected a parameter type of pbrt-v4, found \"point\" (now called \"point3\")"},
    {"string_for_number", "WorldBegin\nShape \"sphere\" \"float radius\" \"1\"",
     "2:16: expected float values for \"radius\", found the string \"1\""},
    {"number_for_string", "WorldBegin\nShape \"plymesh\" \"string filename\" 1",
     "2:17: expected a string in quotation marks for \"filename\", found 1"},
    {"quoted_boolean", "WorldBegin\nAreaLightSource \"diffuse\" \"bool twosided\" \"true\"",
     "2:27: expected true or false for \"twosided\", without quotation marks"},
    {"fraction_for_integer", "WorldBegin\nShape \"loopsubdiv\" \"integer levels\" 1.5",
     "2:20: expected integer values for \"levels\", found 1.5"},
    {"two_numbers_for_one", "WorldBegin\nShape \"sphere\" \"float radius\" [1 2]",
     "2:16: expected 1 value for \"radius\", found 2"},
    {"not_triples", "WorldBegin\nShape \"trianglemesh\" \"point3 P\" [0 0 0 1]",
     "2:22: expected a multiple of 3 numbers for \"P\", found 4"},
    {"parameter_twice", "WorldBegin\nShape \"sphere\" \"float radius\" 1 \"float radius\" 2",
     "2:33: expected each parameter once, found \"radius\" again"},
    {"unknown_parameter", "WorldBegin\nShape \"sphere\" \"float radus\" 1",
     "2:16: expected a parameter that \"sphere\" has, found \"radus\" (did you mean \"radius\"?)"},
    {"parameter_of_another_type", "WorldBegin\nShape \"sphere\" \"integer radius\" 1",
     "2:16: expected \"radius\" of \"sphere\" in another type, found \"integer\""},
    {"no_points", "WorldBegin\nShape \"trianglemesh\" \"integer indices\" [0 1 2]",
     "2:1: expected \"trianglemesh\" \"point3 P\" for \"P\", found none"},
    {"no_indices", "WorldBegin\nShape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0 1 1 1]",
     "2:1: expected \"trianglemesh\" \"integer indices\""},
    {"index_too_large",
     "WorldBegin\nShape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"integer indices\" [0 1 3]",
     "2:53: expected vertices below 3 for \"indices\", found 3"},
    {"negative_index",
     "WorldBegin\nShape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"integer indices\" [0 1 -1]",
     "2:53: expected indices of at least 0 for \"indices\", found -1"},
    {"incomplete_triangle",
     "WorldBegin\nShape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"integer indices\" [0 1]",
     "2:53: expected a multiple of 3 values for \"indices\", found 2"},
    {"radius", "WorldBegin\nShape \"sphere\" \"float radius\" -1",
     "2:16: expected a radius above 0 for \"radius\", found -1"},
    {"inner_radius", "WorldBegin\nShape \"disk\" \"float innerradius\" 2", "2:14: expected an inner radius"},
    {"flat_cylinder", "WorldBegin\nShape \"cylinder\" \"float zmin\" 1",
     "2:18: expected zmin below zmax for \"zmin\", found 1 and 1"},
    {"phimax", "WorldBegin\nShape \"sphere\" \"float phimax\" 0",
     "2:16: expected an angle above 0 for \"phimax\", found 0"},
    {"too_many_levels",
     "WorldBegin\nShape \"loopsubdiv\" \"integer levels\" 30 \"point3 P\" [0 0 0 1 0 0 0 1 0]",
     "2:20: expected 0 to 8 levels for \"levels\", found 30"},
    {"bilinear_uv",
     "WorldBegin\nShape \"bilinearmesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0 1 1 0] \"point2 uv\" [0 0]",
     "2:59: expected 4 values for \"uv\", found 1"},
    {"no_ply", "WorldBegin\nShape \"plymesh\" \"string filename\" \"none.ply\"",
     "2:1: expected a file that can be read, found \"none.ply\""},
    {"ply_outside", "WorldBegin\nShape \"plymesh\" \"string filename\" \"../x.ply\"",
     "2:1: expected a file inside the scene's folder"},
    {"ply_absolute", "WorldBegin\nShape \"plymesh\" \"string filename\" \"/etc/passwd\"",
     "2:1: expected a file inside the scene's folder"},
    {"include_missing", "Include \"none.pbrt\"", "1:1: expected a file that can be read"},
    {"include_outside", "Include \"../none.pbrt\"", "1:1: expected a file inside the scene's folder"},
    {"include_itself", "Include \"scene.pbrt\"",
     "1:1: expected at most 32 files inside each other, found more"},
    {"import_before_world", "Import \"scene.pbrt\"",
     "1:1: expected WorldBegin before the scene's description, found Import"},
    {"unknown_material", "WorldBegin\nMaterial \"difuse\"\nShape \"sphere\"",
     "2:1: expected a material among"},
    {"named_material_missing", "WorldBegin\nNamedMaterial \"red\"\nShape \"sphere\"",
     "2:15: expected the name of a material, found \"red\""},
    {"named_material_without_type", "WorldBegin\nMakeNamedMaterial \"red\" \"rgb reflectance\" [1 0 0]",
     "2:1: expected \"string type\" in MakeNamedMaterial \"red\", found none"},
    {"named_material_twice",
     "WorldBegin MakeNamedMaterial \"a\" \"string type\" \"diffuse\" MakeNamedMaterial \"a\" \"string type\" "
     "\"diffuse\"",
     "1:58: expected a new name for the material"},
    {"material_parameter", "WorldBegin\nMaterial \"diffuse\" \"rgb reflectence\" [1 0 0]\nShape \"sphere\"",
     "2:20: expected a parameter that \"diffuse\" has, found \"reflectence\" (did you mean "
     "\"reflectance\"?)"},
    {"unused_material_is_checked",
     "WorldBegin\nMaterial \"diffuse\" \"rgb reflectence\" [1 0 0]\nMaterial \"diffuse\"\nShape \"sphere\"",
     "2:20: expected a parameter that \"diffuse\" has"},
    {"negative_rgb", "WorldBegin\nMaterial \"diffuse\" \"rgb reflectance\" [1 0 -1]\nShape \"sphere\"",
     "2:20: expected rgb of at least 0 for \"reflectance\", found 1 0 -1"},
    {"two_of_rgb", "WorldBegin\nMaterial \"diffuse\" \"rgb reflectance\" [1 0]\nShape \"sphere\"",
     "2:20: expected a multiple of 3 numbers for \"reflectance\", found 2"},
    {"unknown_metal",
     "WorldBegin\nMaterial \"conductor\" \"spectrum eta\" \"metal-Ax-eta\"\nShape \"sphere\"",
     "2:22: expected the name of a spectrum, or a file of wavelengths and values, found \"metal-Ax-eta\" "
     "(did you mean"},
    {"metal_and_reflectance",
     "WorldBegin\nMaterial \"conductor\" \"rgb reflectance\" [1 1 1] \"spectrum eta\" "
     "\"metal-Ag-eta\"\nShape \"sphere\"",
     "2:22: expected either \"reflectance\" or \"eta\" and \"k\" for \"reflectance\", found both"},
    {"wavelengths_fall",
     "WorldBegin\nMaterial \"diffuse\" \"spectrum reflectance\" [500 1 400 1]\nShape \"sphere\"",
     "2:20: expected increasing wavelengths, found 400 after 500"},
    {"odd_spectrum",
     "WorldBegin\nMaterial \"diffuse\" \"spectrum reflectance\" [500 1 400]\nShape \"sphere\"",
     "2:20: expected pairs of wavelength and value"},
    {"cold_blackbody", "WorldBegin\nLightSource \"point\" \"blackbody I\" 0\nShape \"sphere\"",
     "2:21: expected a temperature of 100 to 1000000 K, found 0"},
    {"refraction_index", "WorldBegin\nMaterial \"dielectric\" \"float eta\" 0\nShape \"sphere\"",
     "2:23: expected an index of refraction above 0 for \"eta\", found 0"},
    {"mix_of_one", "WorldBegin\nMaterial \"mix\" \"string materials\" \"a\"\nShape \"sphere\"",
     "2:16: expected two names of materials for \"materials\", found 1"},
    {"mix_of_itself",
     "WorldBegin\nMakeNamedMaterial \"a\" \"string type\" \"mix\" \"string materials\" [\"a\" "
     "\"a\"]\nNamedMaterial \"a\" Shape \"sphere\"",
     "2:1: expected mixed materials that end, found a circle"},
    {"texture_missing", "WorldBegin\nMaterial \"diffuse\" \"texture reflectance\" \"wod\"\nShape \"sphere\"",
     "2:20: expected the name of a spectrum texture, found \"wod\""},
    {"texture_circle",
     "WorldBegin\nTexture \"a\" \"spectrum\" \"scale\" \"texture tex\" \"a\"\nMaterial \"diffuse\" \"texture "
     "reflectance\" \"a\"\nShape \"sphere\"",
     "2:32: expected at most 64 textures in a row, found more, or a circle"},
    {"texture_value_type", "WorldBegin\nTexture \"a\" \"color\" \"constant\"",
     "2:1: expected a texture of float or spectrum, found \"color\""},
    {"texture_twice", "WorldBegin Texture \"a\" \"float\" \"constant\" Texture \"a\" \"float\" \"constant\"",
     "1:43: expected a new name for the float texture"},
    {"texture_type",
     "WorldBegin\nTexture \"a\" \"spectrum\" \"imagmap\"\nMaterial \"diffuse\" \"texture reflectance\" "
     "\"a\"\nShape \"sphere\"",
     "2:1: expected a texture among"},
    {"texture_file",
     "WorldBegin\nTexture \"a\" \"spectrum\" \"imagemap\" \"string filename\" \"none.png\"\nMaterial "
     "\"diffuse\" \"texture reflectance\" \"a\"\nShape \"sphere\"",
     "2:1: expected a file that can be read"},
    {"texture_wrap",
     "WorldBegin\nTexture \"a\" \"spectrum\" \"imagemap\" \"string filename\" \"x.png\" \"string wrap\" "
     "\"repet\"\nMaterial \"diffuse\" \"texture reflectance\" \"a\"\nShape \"sphere\"",
     "2:61: expected the wrap"},
    {"unknown_light", "WorldBegin\nLightSource \"pont\"\nShape \"sphere\"", "2:1: expected a light among"},
    {"light_parameter", "WorldBegin\nLightSource \"point\" \"rgb L\" [1 1 1]\nShape \"sphere\"",
     "2:21: expected a parameter that \"point\" has, found \"L\" (did you mean \"I\"?)"},
    {"distant_without_direction",
     "WorldBegin\nLightSource \"distant\" \"point3 from\" [0 0 1]\nShape \"sphere\"",
     "2:1: expected \"distant\" a point apart from \"from\""},
    {"spot_angles", "WorldBegin\nLightSource \"spot\" \"float coneangle\" 2\nShape \"sphere\"",
     "2:20: expected an angle of 0 to 180 degrees"},
    {"negative_scale", "WorldBegin\nLightSource \"point\" \"float scale\" -1\nShape \"sphere\"",
     "2:21: expected a scale of at least 0 for \"scale\", found -1"},
    {"area_light_type", "WorldBegin\nAreaLightSource \"difuse\"\nShape \"sphere\"",
     "2:1: expected the area light \"diffuse\", found \"difuse\" (did you mean \"diffuse\"?)"},
    {"unknown_camera", "Camera \"perspectiv\"\nWorldBegin\nShape \"sphere\"", "1:1: expected a camera among"},
    {"fov", "Camera \"perspective\" \"float fov\" 180\nWorldBegin\nShape \"sphere\"",
     "1:22: expected an angle between 0 and 180 degrees for \"fov\", found 180"},
    {"screen_window",
     "Camera \"perspective\" \"float screenwindow\" [1 -1 0 1]\nWorldBegin\nShape \"sphere\"",
     "1:22: expected x0 < x1 and y0 < y1"},
    {"resolution", "Film \"rgb\" \"integer xresolution\" 0\nWorldBegin\nShape \"sphere\"",
     "1:12: expected 1 to 65536 pixels for \"xresolution\", found 0"},
    {"crop", "Film \"rgb\" \"float cropwindow\" [1 0 0 1]\nWorldBegin\nShape \"sphere\"",
     "1:12: expected a window that holds pixels"},
    {"film_type", "Film \"image\"\nWorldBegin\nShape \"sphere\"",
     "1:1: expected a film among rgb, gbuffer or spectral"},
    {"iso", "Film \"rgb\" \"float iso\" 0\nWorldBegin\nShape \"sphere\"",
     "1:12: expected a sensitivity above 0"},
    {"closed_shutter", "Camera \"perspective\" \"float shutterclose\" 0\nWorldBegin\nShape \"sphere\"",
     "1:22: expected a shutter that opens"},
};

class PbrtMalformed : public ::testing::TestWithParam<Damage> {};

TEST_P(PbrtMalformed, EndsInOneLineWithItsPlace) {
    const TempFolder folder;
    const std::string path = folder.write("scene.pbrt", GetParam().text);
    const std::string message = error_of(path);
    EXPECT_NE(message.find(std::string{"scene.pbrt:"} + GetParam().message), message.npos) << message;
    EXPECT_EQ(message.find('\n'), message.npos) << message;
    EXPECT_LT(message.size(), 900u) << message;
}

INSTANTIATE_TEST_SUITE_P(All, PbrtMalformed, ::testing::ValuesIn(damages),
                         [](const auto& damage) { return std::string{damage.param.name}; });

TEST(PbrtHostile, EveryPrefixOfASceneEndsInAMessageOrAScene) {
    const std::string text =
        "LookAt 0 0 -5 0 0 0 0 1 0\nCamera \"perspective\" \"float fov\" 40\nWorldBegin\n"
        "Texture \"t\" \"spectrum\" \"checkerboard\" \"rgb tex1\" [1 0 0]\n"
        "AttributeBegin\nMaterial \"diffuse\" \"texture reflectance\" \"t\"\n"
        "Shape \"sphere\" \"float radius\" [1]\nAttributeEnd\n";
    const TempFolder folder;
    for (std::size_t length = 0; length < text.size(); ++length) {
        const std::string path = folder.write("cut.pbrt", text.substr(0, length));
        const std::string message = error_of(path);
        EXPECT_TRUE(message.empty() || message.rfind(path, 0) == 0) << message;
    }
}

TEST(PbrtHostile, DeepNestingHasALimit) {
    std::string text = "WorldBegin\n";
    for (int i = 0; i < 20'000; ++i) text += "AttributeBegin ";
    const TempFolder folder;
    EXPECT_NE(error_of(folder.write("deep.pbrt", text)).find("at most 10000 nested AttributeBegin"),
              std::string::npos);
}

TEST(PbrtHostile, LinksThatLeadOutsideAreRefused) {
    const TempFolder folder, outside;
    (void)outside.write("secret.pbrt", "WorldBegin");
    std::filesystem::create_symlink(outside.path("secret.pbrt"), folder.path("link.pbrt"));
    const std::string path = folder.write("scene.pbrt", "Include \"link.pbrt\"");
    EXPECT_NE(error_of(path).find("a link that leads outside"), std::string::npos);
}

}  // namespace
}  // namespace relumine
