// SPDX-License-Identifier: Apache-2.0
// read_image and write_image: formats by content and by extension, sRGB, dither, and files that survive.
#include <png.h>

#include <array>
#include <cmath>
#include <limits>

#include "image/byte_image.hpp"
#include "image/quantize.hpp"
#include "image/srgb.hpp"
#include "image/test_support.hpp"
#include "relumine/image.hpp"

namespace relumine {
namespace {

using test::contains;
using test::Folder;
using test::image_error;

Image grey_picture(int width, int height, float value) {
    return make_picture(width, height, {"R", "G", "B"},
                        std::vector<float>(static_cast<std::size_t>(3 * width * height), value));
}

TEST(Srgb, CurveMeetsKnownValuesAndInvertsItself) {
    EXPECT_NEAR(linear_from_srgb(0.5), 0.21404114048223255, 1e-15);
    EXPECT_NEAR(srgb_from_linear(0.18), 0.46135612950044164, 1e-12);
    EXPECT_DOUBLE_EQ(linear_from_srgb(1), 1);
    EXPECT_DOUBLE_EQ(srgb_from_linear(1), 1);
    for (int i = 0; i <= 65535; ++i)
        ASSERT_NEAR(srgb_from_linear(linear_from_srgb(i / 65535.0)), i / 65535.0, 1e-7);
}

TEST(ReadImage, ContentDecidesNotTheName) {
    const Folder folder;
    const Image image = test::noise_picture(4, 3);
    write_image(image, folder.file("a.exr"));
    std::filesystem::rename(folder.file("a.exr"), folder.file("a.png"));
    EXPECT_EQ(read_image(folder.file("a.png")).layer()->pixels, image.layer()->pixels);
}

TEST(ReadImage, EveryByteOfAPngSurvivesLinearAndBack) {
    const Folder folder;
    std::vector<std::uint8_t> rgb;
    for (unsigned i = 0; i < 3 * 256 * 64; ++i) rgb.push_back(static_cast<std::uint8_t>(i / 3 % 256));
    test::store(folder.file("a.png"), encode_png(256, 64, rgb));
    const Image image = read_image(folder.file("a.png"));
    EXPECT_FLOAT_EQ(image.rgb(128, 0)[0], static_cast<float>(linear_from_srgb(128 / 255.0)));
    EXPECT_EQ(quantize(image, 0), rgb);
}

TEST(ReadImage, MissingFoldersAndStrangersAreNamed) {
    const Folder folder;
    EXPECT_TRUE(contains(image_error([&] { (void)read_image(folder.file("none.exr")); }), "none.exr"));
    EXPECT_TRUE(contains(image_error([&] { (void)read_image(folder.file(".")); }), "a folder"));
    test::store(folder.file("empty.exr"), {});
    EXPECT_TRUE(
        contains(image_error([&] { (void)read_image(folder.file("empty.exr")); }), "found an empty file"));
    test::store(folder.file("text.exr"), test::bytes_of("hello"));
    EXPECT_TRUE(contains(image_error([&] { (void)read_image(folder.file("text.exr")); }),
                         "text.exr: expected an EXR, PFM, HDR, PNG or JPEG picture, found other content"));
}

TEST(ReadImage, EverySixteenthOfEveryFormatIsAnError) {
    const Folder folder;
    const Image image = test::noise_picture(32, 24);
    for (const char* name : {"a.exr", "a.png", "a.pfm"}) {
        write_image(image, folder.file(name));
        const std::vector<std::uint8_t> whole = test::load(folder.file(name));
        for (std::size_t i = 0; i < 16; ++i) {
            test::store(folder.file(name), std::span(whole).first(whole.size() * i / 16));
            const std::string message = image_error([&] { (void)read_image(folder.file(name)); });
            EXPECT_TRUE(contains(message, std::string(name) + ": expected ")) << message;
        }
    }
}

TEST(ReadImage, AlphaIsKeptWhereAPixelIsNotOpaque) {
    const Folder folder;
    const std::vector<std::uint8_t> rgba{255, 0, 0, 255, 0, 255, 0, 51};
    png_image png{};
    png.version = PNG_IMAGE_VERSION;
    png.width = 2;
    png.height = 1;
    png.format = PNG_FORMAT_RGBA;
    ASSERT_TRUE(png_image_write_to_file(&png, folder.file("a.png").c_str(), 0, rgba.data(), 0, nullptr));
    const Image image = read_image(folder.file("a.png"));
    EXPECT_EQ(image.layer()->channels, (std::vector<std::string>{"R", "G", "B", "A"}));
    EXPECT_EQ(image.layer()->pixels, (std::vector<float>{1, 0, 0, 1, 0, 1, 0, 0.2f}));
    write_image(test::noise_picture(2, 2), folder.file("b.png"));
    EXPECT_EQ(read_image(folder.file("b.png")).layer()->channels.size(), 3u);
}

// dither

TEST(Quantize, DitherKeepsTheMeanOfAnEvenArea) {
    for (const double level : {0.3, 17.5, 100.25, 254.9}) {
        const Image image = grey_picture(256, 256, static_cast<float>(linear_from_srgb(level / 255)));
        double sum = 0;
        for (const std::uint8_t byte : quantize(image, 0)) {
            ASSERT_LE(std::abs(byte - level), 1);
            sum += byte;
        }
        // 196608 draws: σ of the mean ≤ 0.5/√196608 = 0.0011 levels; 5 σ
        EXPECT_NEAR(sum / (3 * 256 * 256), level, 0.006);
    }
}

TEST(Quantize, BlackWhiteAndTheRestOfTheScale) {
    const float inf = std::numeric_limits<float>::infinity();
    const auto all = [](float value, float exposure = 0) {
        return quantize(grey_picture(40, 40, value), exposure);
    };
    const auto even = [](std::uint8_t byte) { return std::vector<std::uint8_t>(3 * 40 * 40, byte); };
    EXPECT_EQ(all(0), even(0));
    EXPECT_EQ(all(1), even(255));
    EXPECT_EQ(all(0.25f, 2), even(255));
    EXPECT_EQ(all(4, -2), even(255));
    EXPECT_EQ(all(1e30f), even(255));
    EXPECT_EQ(all(inf), even(255));
    EXPECT_EQ(all(-inf), even(0));
    EXPECT_EQ(all(-1), even(0));
    EXPECT_EQ(all(std::nanf("")), even(0));
}

TEST(Quantize, ACropHasTheDitherOfTheWholeFrame) {
    const Image whole = grey_picture(8, 8, 0.3f);
    Image crop = grey_picture(3, 2, 0.3f);
    crop.window = {4, 5, 7, 7};
    const std::vector<std::uint8_t> all = quantize(whole, 0), part = quantize(crop, 0);
    for (std::size_t y = 0; y < 2; ++y)
        for (std::size_t i = 0; i < 9; ++i) EXPECT_EQ(part[y * 9 + i], all[(5 + y) * 24 + 12 + i]);
}

TEST(Quantize, IsTheSameEveryTime) {
    const Image image = test::noise_picture(20, 20);
    EXPECT_EQ(quantize(image, 0.5f), quantize(image, 0.5f));
}

// writing

TEST(WriteImage, ExtensionDecidesWhateverItsCase) {
    const Folder folder;
    const Image image = test::noise_picture(3, 3);
    for (const char* name : {"a.EXR", "a.Pfm", "a.PNG"}) {
        write_image(image, folder.file(name));
        EXPECT_EQ(read_image(folder.file(name)).width, 3);
    }
    EXPECT_EQ(folder.count_files(), 3u);
}

TEST(WriteImage, OtherExtensionsAreRefused) {
    const Image image = test::noise_picture(1, 1);
    for (const char* name : {"a.jpg", "a", "exr", ".exr", "a.", "a.exr.tmp", "a.hdr"})
        EXPECT_THROW(write_image(image, name), SettingsError) << name;
}

TEST(WriteImage, ImagesThatContradictThemselvesAreRefused) {
    const Folder folder;
    const Image image = test::noise_picture(2, 2);
    const auto refused = [&](const std::function<void(Image&)>& change) {
        Image changed = image;
        change(changed);
        EXPECT_THROW(write_image(changed, folder.file("a.exr")), SettingsError);
    };
    refused([](Image& i) { i.layers.clear(); });
    refused([](Image& i) { i.width = 0; });
    refused([](Image& i) { i.height = 3; });
    refused([](Image& i) { i.layers[0].pixels.pop_back(); });
    refused([](Image& i) { i.layers[0].channels.clear(); });
    refused([](Image& i) { i.window = {0, 0, 1, 2}; });
    EXPECT_EQ(folder.count_files(), 0u);
}

TEST(WriteImage, PngAndPfmNeedThePictureItself) {
    const Folder folder;
    Image image = test::noise_picture(2, 2);
    image.layers[0].name = "albedo";
    EXPECT_THROW(write_image(image, folder.file("a.png")), SettingsError);
    EXPECT_THROW(write_image(image, folder.file("a.pfm")), SettingsError);
    write_image(image, folder.file("a.exr"));
    EXPECT_EQ(read_image(folder.file("a.exr")).layer(), nullptr);
}

TEST(WriteImage, ExposureMustBeFinite) {
    EXPECT_THROW(write_image(test::noise_picture(1, 1), "a.png", {.exposure = std::nanf("")}), SettingsError);
}

TEST(WriteImage, AnImageWithoutAWindowFillsItsFrame) {
    const Folder folder;
    Image image = test::noise_picture(5, 4);
    image.window = {};
    image.frame_width = image.frame_height = 0;
    write_image(image, folder.file("a.exr"));
    EXPECT_EQ(read_image(folder.file("a.exr")).window, (PixelRect{0, 0, 5, 4}));
    EXPECT_EQ(read_image(folder.file("a.exr")).frame_width, 5);
}

TEST(WriteImage, AFileSurvivesAWriteThatFails) {
    const Folder folder;
    const Image good = test::noise_picture(2, 2);
    write_image(good, folder.file("a.exr"));
    const std::vector<std::uint8_t> before = test::load(folder.file("a.exr"));
    Image bad = test::noise_picture(9, 9);
    bad.metadata["channels"] = "reserved";
    EXPECT_THROW(write_image(bad, folder.file("a.exr")), SettingsError);
    EXPECT_EQ(test::load(folder.file("a.exr")), before);
    EXPECT_EQ(folder.count_files(), 1u);
}

TEST(WriteImage, ATargetThatCannotBeReplacedIsAnOutputError) {
    const Folder folder;
    std::filesystem::create_directory(folder.file("a.exr"));
    EXPECT_THROW(write_image(test::noise_picture(2, 2), folder.file("a.exr")), OutputError);
    EXPECT_THROW(write_image(test::noise_picture(2, 2), folder.file("none/a.exr")), OutputError);
    EXPECT_EQ(folder.count_files(), 1u);
}

}  // namespace
}  // namespace relumine
