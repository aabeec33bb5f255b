// SPDX-License-Identifier: Apache-2.0
// Regression pictures: tiny scenes against stored references that `path` converged to. docs/validation.md.
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "relumine/compare.hpp"
#include "tests/pictures/reference.hpp"
#include "tests/run_command.hpp"

namespace relumine::pictures {
namespace {

/// Of each picture by `path`, for all its blocks and channels together; seeds are fixed.
constexpr double false_positive_rate = 1e-4;
constexpr double planted = 1.03;  // a brightness that every picture must tell from 1

std::string test_name(std::string name) {
    for (char& c : name)
        if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '_';
    return name;
}

class Pictures : public ::testing::TestWithParam<PictureCase> {};
INSTANTIATE_TEST_SUITE_P(All, Pictures, ::testing::ValuesIn(picture_cases()),
                         [](const auto& c) { return test_name(c.param.name); });

/// z of blocks of 4 × 4 pixels and of the mean, per channel, Šidák. 3 % more light must be caught.
TEST_P(Pictures, PathIsItsReference) {
    const PictureCase& picture = GetParam();
    const Reference reference = read_reference(reference_path(picture));
    Image image = render_picture(picture, load_picture_scene(picture), path_settings(picture));
    const Fit good = fit(image, picture.samples, reference);
    EXPECT_GT(good.p, false_positive_rate) << "z " << good.worst_z << ", of the mean " << good.mean_z;
    for (float& value : image.layers.front().pixels) value *= static_cast<float>(planted);
    EXPECT_LT(fit(image, picture.samples, reference).p, false_positive_rate) << good.mean_error;
}

class PictureMethods : public ::testing::TestWithParam<MethodCase> {};
INSTANTIATE_TEST_SUITE_P(All, PictureMethods, ::testing::ValuesIn(method_cases()),
                         [](const auto& c) { return test_name(c.param.picture + " " + c.param.label); });

/// Within the tolerance that the table states: most of these methods are biased.
TEST_P(PictureMethods, IsCloseToWhatPathConvergesTo) {
    const PictureCase& picture = find_picture(GetParam().picture);
    const Tolerance& tolerance = GetParam().tolerance;
    const Reference reference = read_reference(reference_path(picture));
    Image image = render(load_picture_scene(picture), method_settings(picture, GetParam().settings));
    const Comparison c = compare_images(image, reference.mean, {.block_size = 8});
    EXPECT_TRUE(c.all_finite());
    EXPECT_NEAR(c.mean_ratio, 1, tolerance.mean);
    EXPECT_LE(c.block_difference_max, tolerance.block);
    EXPECT_LE(flip(image, reference.mean).mean, tolerance.flip);
    for (float& value : image.layers.front().pixels) value *= 1.1f;  // the mutant must be caught
    EXPECT_GT(std::abs(compare_images(image, reference.mean).mean_ratio - 1), tolerance.mean);
}

/// A picture of which one word of its scene was changed.
struct Mutant {
    const char *name, *picture, *from, *to;
};
void PrintTo(const Mutant& mutant, std::ostream* out) { *out << mutant.name; }

class PictureMutants : public ::testing::TestWithParam<Mutant> {};
INSTANTIATE_TEST_SUITE_P(
    All, PictureMutants,
    ::testing::Values(
        Mutant{"LampTwoPercentBrighter", "room", "\"emissiveStrength\": 11", "\"emissiveStrength\": 11.22"},
        Mutant{"NormalMapFlipped", "normal-map", "\"scale\": 1.0", "\"scale\": -1.0"},
        Mutant{"MirroredInsteadOfRepeated", "wraps", "\"wrapS\": 10497", "\"wrapS\": 33648"},
        Mutant{"RepeatedInsteadOfClamped", "wraps", "\"wrapS\": 33071", "\"wrapS\": 10497"},
        Mutant{"RoughnessOff", "metals", "\"roughnessFactor\": 0.65", "\"roughnessFactor\": 0.6"},
        Mutant{"BrushedLess", "brushed", "\"anisotropyStrength\": 0.6", "\"anisotropyStrength\": 0.5"},
        Mutant{"BrushesTurned", "brushed", "\"anisotropyRotation\": 0.5", "\"anisotropyRotation\": 0.9"},
        Mutant{"IndexOff", "glass", "\"ior\": 1.33", "\"ior\": 1.4"},
        Mutant{"AbsorptionOff", "glass", "\"attenuationDistance\": 0.7", "\"attenuationDistance\": 0.75"},
        Mutant{"MaskInsteadOfBlend", "alpha", "\"alphaMode\": \"BLEND\"", "\"alphaMode\": \"MASK\""},
        Mutant{"ConeWider", "punctual", "\"outerConeAngle\": 0.5", "\"outerConeAngle\": 0.53"},
        Mutant{"LensWider", "thin-lens", "\"float lensradius\" .12", "\"float lensradius\" .3"},
        Mutant{"FocusOff", "thin-lens", "\"float focaldistance\" 4.2", "\"float focaldistance\" 3"},
        Mutant{"CoatRougher", "pbrt-materials", "\"float roughness\" .1", "\"float roughness\" .3"},
        Mutant{"CheckersFiner", "pbrt-textures", "\"float uscale\" 6", "\"float uscale\" 6.5"}),
    [](const auto& c) { return c.param.name; });

TEST_P(PictureMutants, AreCaught) {
    const Mutant& mutant = GetParam();
    PictureCase picture = find_picture(mutant.picture);
    const Reference reference = read_reference(reference_path(picture));
    const std::filesystem::path source =
        std::filesystem::path(RELUMINE_SOURCE_DIR) / "tests/pictures/scenes" / picture.file;
    std::string text = test::read_bytes(source);
    const std::size_t at = text.find(mutant.from);
    ASSERT_NE(at, std::string::npos) << mutant.from;
    text.replace(at, std::string(mutant.from).size(), mutant.to);
    const test::ScratchFolder folder;
    for (const char* name : {"letter.png", "gonio.pfm"})  // what scenes refer to
        std::filesystem::copy_file(source.parent_path() / name, folder / name);
    test::write_bytes(folder / picture.file, text);
    SceneOptions options;
    if (!picture.environment.empty())
        options.environment = std::string(RELUMINE_SOURCE_DIR) + "/scenes" + picture.environment;
    const Image image =
        render_picture(picture, load_scene(folder / picture.file, options), path_settings(picture));
    EXPECT_LT(fit(image, picture.samples, reference).p, false_positive_rate);
}

TEST(PictureScenes, AreWhatTheirScriptMakes) {
    const test::ScratchFolder folder;
    const std::string root = RELUMINE_SOURCE_DIR "/tests/pictures/";
    ASSERT_EQ(std::system(("python3 '" + root + "scenes.py' '" + folder.path().string() + "'").c_str()), 0);
    int made = 0;
    for (const auto& entry : std::filesystem::directory_iterator(folder.path())) {
        ++made;
        const std::string name = entry.path().filename();
        EXPECT_EQ(test::read_bytes(entry.path()), test::read_bytes(root + "scenes/" + name)) << name;
    }
    EXPECT_GE(made, 20);
}

}  // namespace
}  // namespace relumine::pictures
