// SPDX-License-Identifier: Apache-2.0
// OpenEXR: what we write comes back, and what others write (tiles, halves, grey) is understood.
#include "image/exr.hpp"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <ImfTiledOutputFile.h>
#include <half.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "image/exr_header.hpp"
#include "image/exr_stream.hpp"
#include "image/test_support.hpp"

namespace relumine {
namespace {

using test::contains;
using test::image_error;
using Bytes = std::vector<std::uint8_t>;
using Names = std::vector<std::string>;

/// A crop of a larger frame with all kinds of layers.
Image layered_image() {
    Image image = test::noise_picture(11, 6);
    image.window = {5, 3, 16, 9};
    image.frame_width = 40;
    image.frame_height = 30;
    image.layers.push_back({"albedo", {"R", "G", "B"}, test::noise(3 * 66, 2)});
    image.layers.push_back({"depth", {"Z"}, test::noise(66, 3)});
    image.layers.push_back({"light.direct", {"R", "G", "B"}, test::noise(3 * 66, 4)});
    image.layers.push_back({"position", {"X", "Y", "Z"}, test::noise(3 * 66, 5)});
    image.metadata = {{"seed", "0"}, {"command", "relumine render \"a b.glb\"\nsecond line"}, {"empty", ""}};
    return image;
}

TEST(Exr, LayersMetadataAndWindowsComeBack) {
    const Image image = layered_image();
    const Image read = decode_exr(encode_exr(image, false), "t");
    EXPECT_EQ(read.width, image.width);
    EXPECT_EQ(read.height, image.height);
    EXPECT_EQ(read.window, image.window);
    EXPECT_EQ(read.frame_width, image.frame_width);
    EXPECT_EQ(read.frame_height, image.frame_height);
    EXPECT_EQ(read.metadata, image.metadata);
    ASSERT_EQ(read.layers.size(), image.layers.size());
    for (std::size_t i = 0; i < image.layers.size(); ++i) {
        EXPECT_EQ(read.layers[i].name, image.layers[i].name);
        EXPECT_EQ(read.layers[i].channels, image.layers[i].channels);
        EXPECT_EQ(read.layers[i].pixels, image.layers[i].pixels);
    }
}

TEST(Exr, HalfFloatsRoundColoursAlone) {
    const Image image = layered_image();
    const Image read = decode_exr(encode_exr(image, true), "t");
    for (const char* name : {"", "albedo"})
        for (std::size_t i = 0; i < image.layer(name)->pixels.size(); ++i)
            ASSERT_EQ(read.layer(name)->pixels[i], static_cast<float>(half(image.layer(name)->pixels[i])));
    EXPECT_EQ(read.layer("depth")->pixels, image.layer("depth")->pixels);
    EXPECT_EQ(read.layer("position")->pixels, image.layer("position")->pixels);
}

TEST(Exr, HalfFloatsKeepFinitePixelsFinite) {
    const float inf = std::numeric_limits<float>::infinity();
    const Image image = make_picture(1, 1, {"R", "G", "B"}, {1e30f, -1e30f, inf});
    EXPECT_EQ(decode_exr(encode_exr(image, true), "t").layer()->pixels,
              (std::vector<float>{65504, -65504, inf}));
}

TEST(Exr, NegativeAndNonFinitePixelsAreNotAltered) {
    const float inf = std::numeric_limits<float>::infinity();
    const Image image = make_picture(1, 1, {"R", "G", "B"}, {-3, -inf, std::nanf("")});
    const std::vector<float> read = decode_exr(encode_exr(image, false), "t").layer()->pixels;
    EXPECT_EQ(read[0], -3);
    EXPECT_EQ(read[1], -inf);
    EXPECT_TRUE(std::isnan(read[2]));
}

TEST(Exr, AlphaComesLastAndOtherChannelsStay) {
    const Image image = make_picture(1, 1, {"R", "G", "B", "Z", "A"}, {1, 2, 3, 9, 0.5f});
    const Image read = decode_exr(encode_exr(image, false), "t");
    EXPECT_EQ(read.layer()->channels, (Names{"R", "G", "B", "Z", "A"}));
    EXPECT_EQ(read.layer()->pixels, (std::vector<float>{1, 2, 3, 9, 0.5f}));
}

// files of others

/// Writes one channel per name with the values 0, 1, 2, … in float.
Bytes foreign_file(Imf::Header header, const Names& names) {
    header.compression() = Imf::PIZ_COMPRESSION;
    const Imath::Box2i window = header.dataWindow();
    const auto width = static_cast<std::size_t>(window.max.x - window.min.x + 1);
    std::vector<float> values(width * static_cast<std::size_t>(window.max.y - window.min.y + 1));
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<float>(i);
    Imf::FrameBuffer buffer;
    for (const std::string& name : names) {
        header.channels().insert(name, Imf::Channel(Imf::FLOAT));
        buffer.insert(name, Imf::Slice::Make(Imf::FLOAT, values.data(), window));
    }
    ExrOutput output;
    if (header.hasTileDescription()) {
        Imf::TiledOutputFile file(output, header, 0);
        file.setFrameBuffer(buffer);
        file.writeTiles(0, file.numXTiles() - 1, 0, file.numYTiles() - 1);
    } else {
        Imf::OutputFile file(output, header, 0);
        file.setFrameBuffer(buffer);
        file.writePixels(window.max.y - window.min.y + 1);
    }
    return output.take_bytes();
}

TEST(Exr, TiledFilesAreRead) {
    Imf::Header header({{0, 0}, {99, 49}}, {{-3, -2}, {36, 37}});
    header.setTileDescription({16, 8, Imf::ONE_LEVEL});
    const Image read = decode_exr(foreign_file(header, {"R", "G", "B"}), "t");
    EXPECT_EQ(read.window, (PixelRect{-3, -2, 37, 38}));
    EXPECT_EQ(read.frame_width, 100);
    EXPECT_EQ(read.rgb(39, 39)[1], 40 * 40 - 1);
}

TEST(Exr, LuminanceAloneIsGrey) {
    const Image read = decode_exr(foreign_file(Imf::Header(4, 3), {"Y"}), "t");
    EXPECT_EQ(read.layer()->channels, Names{"Y"});
    EXPECT_EQ(read.rgb(3, 2), (std::array<float, 3>{11, 11, 11}));
}

TEST(Exr, LuminanceWithAlphaIsGreyToo) {
    const Image read = decode_exr(foreign_file(Imf::Header(4, 3), {"A", "Y"}), "t");
    EXPECT_EQ(read.layer()->channels, (Names{"Y", "A"}));
}

TEST(Exr, HalvesAndIntegersBecomeFloats) {
    Imf::Header header(1, 1);
    header.channels().insert("R", Imf::Channel(Imf::HALF));
    header.channels().insert("id", Imf::Channel(Imf::UINT));
    half red(0.5f);
    unsigned id = 70000;
    Imf::FrameBuffer buffer;
    buffer.insert("R", Imf::Slice(Imf::HALF, reinterpret_cast<char*>(&red), sizeof red, sizeof red));
    buffer.insert("id", Imf::Slice(Imf::UINT, reinterpret_cast<char*>(&id), sizeof id, sizeof id));
    ExrOutput output;
    {
        Imf::OutputFile file(output, header, 0);
        file.setFrameBuffer(buffer);
        file.writePixels(1);
    }
    EXPECT_EQ(decode_exr(output.take_bytes(), "t").layer()->pixels, (std::vector<float>{0.5f, 70000}));
}

// damage

TEST(Exr, EverySixteenthOfAFileIsAnError) {
    for (const bool half_floats : {false, true}) {
        const Bytes exr = encode_exr(layered_image(), half_floats);
        for (std::size_t i = 0; i < 16; ++i)
            (void)image_error([&] { (void)decode_exr(std::span(exr).first(exr.size() * i / 16), "t.exr"); });
        (void)image_error([&] { (void)decode_exr(std::span(exr).first(exr.size() - 1), "t.exr"); });
    }
}

TEST(Exr, EveryTruncationOfTheHeaderIsAnError) {
    const Bytes exr = encode_exr(test::noise_picture(2, 2), false);
    for (std::size_t length = 4; length < exr.size(); ++length)
        (void)image_error([&] { (void)decode_exr(std::span(exr).first(length), "t.exr"); });
}

/// Whatever one flipped byte does, it never does more than throw ImageError.
TEST(Exr, NoFlippedByteDoesMoreThanThrow) {
    const Bytes exr = encode_exr(layered_image(), false);
    for (std::size_t i = 4; i < exr.size(); ++i) {
        Bytes changed = exr;
        changed[i] ^= static_cast<std::uint8_t>(1 + hash(7, i) % 255);
        try {
            (void)decode_exr(changed, "t.exr");
        } catch (const ImageError&) {
        }
    }
}

/// The offset of an attribute's value.
std::size_t value_of(const Bytes& exr, const std::string& attribute, const std::string& type) {
    const std::string head = attribute + '\0' + type + '\0';
    const auto found = std::search(exr.begin(), exr.end(), head.begin(), head.end());
    EXPECT_NE(found, exr.end());
    return static_cast<std::size_t>(found - exr.begin()) + head.size() + 4;
}

void put_i32(Bytes& bytes, std::size_t offset, std::int64_t value) {
    for (std::size_t i = 0; i < 4; ++i)
        bytes[offset + i] = static_cast<std::uint8_t>(static_cast<std::uint64_t>(value) >> (8 * i));
}

TEST(Exr, HugeWindowsAreRefusedBeforeAllocation) {
    const Bytes exr = encode_exr(test::noise_picture(2, 2), false);
    const std::size_t window = value_of(exr, "dataWindow", "box2i");
    const auto with_max = [&](std::int64_t x, std::int64_t y) {
        Bytes changed = exr;
        put_i32(changed, window + 8, x);
        put_i32(changed, window + 12, y);
        return image_error([&] { (void)decode_exr(changed, "t.exr"); });
    };
    EXPECT_TRUE(contains(with_max(0x7fffffff, 0x7fffffff), "found 2147483648 x 2147483648 pixels"));
    EXPECT_TRUE(contains(with_max(-2, 1), "found -1 x 2 pixels"));
    EXPECT_TRUE(contains(with_max(65536, 1), "found 65537 x 2 pixels"));
    EXPECT_TRUE(contains(with_max(16383, 16383), "expected at least"));
}

TEST(Exr, HugeAttributesAreRefusedBeforeAllocation) {
    Bytes exr = encode_exr(test::noise_picture(2, 2), false);
    put_i32(exr, value_of(exr, "dataWindow", "box2i") - 4, 0x7fffffff);
    EXPECT_TRUE(
        contains(image_error([&] { (void)decode_exr(exr, "t.exr"); }), "expected a whole EXR header"));
}

TEST(Exr, HugeTilesAreRefusedBeforeAllocation) {
    Imf::Header header(40, 40);
    header.setTileDescription({16, 8, Imf::ONE_LEVEL});
    Bytes exr = foreign_file(header, {"R"});
    put_i32(exr, value_of(exr, "tiles", "tiledesc"), 0x7ffffff);
    EXPECT_TRUE(contains(image_error([&] { (void)decode_exr(exr, "t.exr"); }), "expected tiles of at most"));
}

TEST(Exr, KindsThatWeDoNotReadAreNamed) {
    const Bytes exr = encode_exr(test::noise_picture(2, 2), false);
    const auto with_version = [&](std::int64_t version) {
        Bytes changed = exr;
        put_i32(changed, 4, version);
        return image_error([&] { (void)decode_exr(changed, "t.exr"); });
    };
    EXPECT_EQ(with_version(0x802), "t.exr: expected an EXR file of flat pixels, found deep ones");
    EXPECT_EQ(with_version(0x1002), "t.exr: expected an EXR file of one part, found several");
    EXPECT_TRUE(contains(with_version(3), "expected EXR version 2, found version field 0x3"));
}

TEST(Exr, SubsampledChannelsAreRefused) {
    Imf::Header header(4, 4);
    header.channels().insert("Y", Imf::Channel(Imf::HALF));
    header.channels().insert("RY", Imf::Channel(Imf::HALF, 2, 2));
    std::vector<half> values(16, half(1.0f));
    Imf::FrameBuffer buffer;
    buffer.insert("Y", Imf::Slice(Imf::HALF, reinterpret_cast<char*>(values.data()), 2, 8));
    buffer.insert("RY", Imf::Slice(Imf::HALF, reinterpret_cast<char*>(values.data()), 2, 4, 2, 2));
    ExrOutput output;
    {
        Imf::OutputFile file(output, header, 0);
        file.setFrameBuffer(buffer);
        file.writePixels(4);
    }
    EXPECT_EQ(image_error([&] { (void)decode_exr(output.take_bytes(), "t.exr"); }),
              "t.exr: expected channels of full resolution, found one value of \"RY\" for 2 x 2 pixels");
}

// writing

TEST(Exr, NamesThatExrReservesAreRefused) {
    Image image = test::noise_picture(1, 1);
    image.metadata["dataWindow"] = "x";
    EXPECT_THROW((void)encode_exr(image, false), SettingsError);
    image.metadata = {{std::string(300, 'a'), "x"}};
    EXPECT_THROW((void)encode_exr(image, false), SettingsError);
}

TEST(Exr, ChannelsOfTheSameNameAreRefused) {
    Image image = test::noise_picture(1, 1);
    image.layers.push_back(image.layers[0]);
    EXPECT_THROW((void)encode_exr(image, false), SettingsError);
}

}  // namespace
}  // namespace relumine
