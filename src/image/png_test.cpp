// SPDX-License-Identifier: Apache-2.0
// PNG: files of every colour type, made by libpng, decode to the RGBA that the specification asks for.
#include "image/png.hpp"

#include <png.h>
#include <zlib.h>

#include <stdexcept>

#include "image/test_support.hpp"

namespace relumine {
namespace {

using test::contains;
using test::image_error;

/// What a test asks libpng to write. `rows` holds packed rows, as PNG stores them.
struct PngSource {
    int width, height, bit_depth, color_type;
    std::vector<std::vector<std::uint8_t>> rows;
    std::vector<png_color> palette{};
    std::vector<std::uint8_t> palette_alpha{};
    int transparent_grey = -1;
    bool interlaced = false;
};

void set_up(png_structp png, png_infop info, const PngSource& source) {
    png_set_IHDR(png, info, static_cast<png_uint_32>(source.width), static_cast<png_uint_32>(source.height),
                 source.bit_depth, source.color_type,
                 source.interlaced ? PNG_INTERLACE_ADAM7 : PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
                 PNG_FILTER_TYPE_DEFAULT);
    if (!source.palette.empty())
        png_set_PLTE(png, info, source.palette.data(), static_cast<int>(source.palette.size()));
    png_color_16 grey{};
    grey.gray = static_cast<png_uint_16>(source.transparent_grey);
    if (source.transparent_grey >= 0) png_set_tRNS(png, info, nullptr, 0, &grey);
    if (!source.palette_alpha.empty())
        png_set_tRNS(png, info, source.palette_alpha.data(), static_cast<int>(source.palette_alpha.size()),
                     nullptr);
}

std::vector<std::uint8_t> write_png(PngSource source) {
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
    png_infop info = png_create_info_struct(png);
    std::vector<std::uint8_t> out;
    png_set_write_fn(
        png, &out,
        [](png_structp p, png_bytep data, std::size_t count) {
            auto* bytes = static_cast<std::vector<std::uint8_t>*>(png_get_io_ptr(p));
            bytes->insert(bytes->end(), data, data + count);
        },
        nullptr);
    set_up(png, info, source);
    png_write_info(png, info);
    std::vector<png_bytep> rows;
    for (auto& row : source.rows) rows.push_back(row.data());
    png_write_image(png, rows.data());
    png_write_end(png, info);
    png_destroy_write_struct(&png, &info);
    return out;
}

using Bytes = std::vector<std::uint8_t>;
using Words = std::vector<std::uint16_t>;

TEST(Png, EncodedRgbDecodesToTheSameBytes) {
    const Bytes rgb{0, 1, 2, 3, 4, 5, 250, 251, 252, 253, 254, 255};
    const ByteImage image = decode_byte_image(encode_png(2, 2, rgb), "t");
    EXPECT_EQ(image.width, 2);
    EXPECT_EQ(image.height, 2);
    EXPECT_TRUE(image.rgba16.empty());
    EXPECT_EQ(image.rgba8, (Bytes{0, 1, 2, 255, 3, 4, 5, 255, 250, 251, 252, 255, 253, 254, 255, 255}));
}

TEST(Png, EncodedFileSaysThatItIsSrgb) {
    const Bytes png = encode_png(1, 1, Bytes{1, 2, 3});
    EXPECT_TRUE(contains(std::string(png.begin(), png.end()), "sRGB"));
}

TEST(Png, GreyOfOneTwoFourBitsIsStretchedToEight) {
    EXPECT_EQ(decode_png(write_png({2, 1, 1, PNG_COLOR_TYPE_GRAY, {{0x40}}}), "t").rgba8,
              (Bytes{0, 0, 0, 255, 255, 255, 255, 255}));
    EXPECT_EQ(decode_png(write_png({2, 1, 2, PNG_COLOR_TYPE_GRAY, {{0x60}}}), "t").rgba8,
              (Bytes{85, 85, 85, 255, 170, 170, 170, 255}));
    EXPECT_EQ(decode_png(write_png({2, 1, 4, PNG_COLOR_TYPE_GRAY, {{0x1f}}}), "t").rgba8,
              (Bytes{17, 17, 17, 255, 255, 255, 255, 255}));
}

TEST(Png, GreyOfEightBitsIsReplicated) {
    EXPECT_EQ(decode_png(write_png({2, 1, 8, PNG_COLOR_TYPE_GRAY, {{7, 9}}}), "t").rgba8,
              (Bytes{7, 7, 7, 255, 9, 9, 9, 255}));
}

TEST(Png, GreyAndAlpha) {
    EXPECT_EQ(decode_png(write_png({1, 1, 8, PNG_COLOR_TYPE_GRAY_ALPHA, {{7, 9}}}), "t").rgba8,
              (Bytes{7, 7, 7, 9}));
}

TEST(Png, SixteenBitsComeInNativeByteOrder) {
    const ByteImage rgb = decode_png(write_png({1, 1, 16, PNG_COLOR_TYPE_RGB, {{1, 2, 3, 4, 5, 6}}}), "t");
    EXPECT_TRUE(rgb.rgba8.empty());
    EXPECT_EQ(rgb.rgba16, (Words{0x0102, 0x0304, 0x0506, 0xffff}));
    const PngSource alpha{1, 1, 16, PNG_COLOR_TYPE_RGB_ALPHA, {{1, 2, 3, 4, 5, 6, 7, 8}}};
    EXPECT_EQ(decode_png(write_png(alpha), "t").rgba16, (Words{0x0102, 0x0304, 0x0506, 0x0708}));
    const PngSource grey{1, 1, 16, PNG_COLOR_TYPE_GRAY, {{1, 2}}};
    EXPECT_EQ(decode_png(write_png(grey), "t").rgba16, (Words{0x0102, 0x0102, 0x0102, 0xffff}));
    const PngSource grey_alpha{1, 1, 16, PNG_COLOR_TYPE_GRAY_ALPHA, {{1, 2, 3, 4}}};
    EXPECT_EQ(decode_png(write_png(grey_alpha), "t").rgba16, (Words{0x0102, 0x0102, 0x0102, 0x0304}));
}

TEST(Png, PaletteWithAndWithoutAlpha) {
    PngSource source{2, 1, 1, PNG_COLOR_TYPE_PALETTE, {{0x40}}, {{1, 2, 3}, {4, 5, 6}}};
    EXPECT_EQ(decode_png(write_png(source), "t").rgba8, (Bytes{1, 2, 3, 255, 4, 5, 6, 255}));
    source.palette_alpha = {10};  // the rest is opaque
    EXPECT_EQ(decode_png(write_png(source), "t").rgba8, (Bytes{1, 2, 3, 10, 4, 5, 6, 255}));
}

TEST(Png, PaletteIndexOutsideThePaletteDoesNoHarm) {
    const PngSource source{2, 1, 4, PNG_COLOR_TYPE_PALETTE, {{0x0f}}, {{1, 2, 3}, {4, 5, 6}}};
    EXPECT_EQ(decode_png(write_png(source), "t").rgba8.size(), 8u);
}

TEST(Png, TransparentGreyBecomesAlpha) {
    PngSource source{2, 1, 8, PNG_COLOR_TYPE_GRAY, {{7, 9}}};
    source.transparent_grey = 9;
    EXPECT_EQ(decode_png(write_png(source), "t").rgba8, (Bytes{7, 7, 7, 255, 9, 9, 9, 0}));
}

TEST(Png, InterlacedDecodesLikeProgressive) {
    PngSource source{13, 9, 8, PNG_COLOR_TYPE_RGB_ALPHA, {}};
    for (unsigned y = 0; y < 9; ++y) {
        Bytes row;
        for (unsigned i = 0; i < 4 * 13; ++i) row.push_back(static_cast<std::uint8_t>(hash(y, i)));
        source.rows.push_back(row);
    }
    const Bytes plain = decode_png(write_png(source), "t").rgba8;
    source.interlaced = true;
    EXPECT_EQ(decode_png(write_png(source), "t").rgba8, plain);
}

// damage

/// A PNG of one IHDR chunk with a correct checksum, and nothing behind it.
Bytes only_header(std::uint32_t width, std::uint32_t height) {
    Bytes png = encode_png(1, 1, Bytes{1, 2, 3});
    png.resize(8 + 25);
    for (unsigned i = 0; i < 4; ++i) {
        png[16 + i] = static_cast<std::uint8_t>(width >> (24 - 8 * i));
        png[20 + i] = static_cast<std::uint8_t>(height >> (24 - 8 * i));
    }
    const uLong crc = crc32(0, png.data() + 12, 17);
    for (unsigned i = 0; i < 4; ++i) png[29 + i] = static_cast<std::uint8_t>(crc >> (24 - 8 * i));
    return png;
}

/// The same, followed by the chunks of a real file of one pixel.
Bytes forged_size(std::uint32_t width, std::uint32_t height) {
    const Bytes real = encode_png(1, 1, Bytes{1, 2, 3});
    Bytes png = only_header(width, height);
    png.insert(png.end(), real.begin() + 33, real.end());
    return png;
}

TEST(Png, HugeAndZeroSizesAreRefusedByNumber) {
    const auto message = [](const Bytes& png) {
        return image_error([&] { (void)decode_png(png, "big.png"); });
    };
    EXPECT_TRUE(contains(message(forged_size(70000, 1)), "big.png: expected 1 to 65536 pixels"));
    EXPECT_TRUE(contains(message(forged_size(60000, 60000)), "found 60000 x 60000 pixels"));
    EXPECT_TRUE(contains(message(forged_size(0x7fffffff, 0x7fffffff)), "2147483647 x 2147483647"));
    EXPECT_TRUE(contains(message(forged_size(0, 5)), "big.png: expected an undamaged PNG file, found"));
}

TEST(Png, MorePixelsThanTheFileCanHoldAreRefusedBeforeAllocation) {
    const std::string message = image_error([] { (void)decode_png(forged_size(16384, 16384), "t"); });
    EXPECT_TRUE(contains(message, "expected at least")) << message;
}

TEST(Png, MoreRowsThanStoredAreAnError) {
    (void)image_error([] { (void)decode_png(forged_size(40, 40), "t"); });
}

TEST(Png, EveryTruncationIsAnError) {
    const Bytes png = encode_png(20, 20, Bytes(1200, 77));
    for (std::size_t length = 0; length < png.size(); ++length)
        (void)image_error([&] { (void)decode_byte_image(std::span(png).first(length), "t"); });
}

TEST(Png, AFlippedBitInThePixelsIsAnError) {
    Bytes png = encode_png(20, 20, Bytes(1200, 77));
    const std::string text(png.begin(), png.end());
    png[text.find("IDAT") + 10] ^= 0x10;
    (void)image_error([&] { (void)decode_png(png, "t"); });
}

TEST(Png, OtherContentIsNamed) {
    EXPECT_EQ(image_error([] { (void)decode_byte_image(test::bytes_of("GIF89a"), "a.gif"); }),
              "a.gif: expected a PNG, JPEG or WebP picture, found other content");
    EXPECT_EQ(image_error([] { (void)decode_byte_image({}, "none"); }),
              "none: expected a PNG, JPEG or WebP picture, found no bytes");
}

}  // namespace
}  // namespace relumine
