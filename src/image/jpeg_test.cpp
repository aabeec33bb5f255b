// SPDX-License-Identifier: Apache-2.0
// JPEG: flat pictures survive its lossy coding to the last level or two, so their bytes can be predicted.
#include "image/jpeg.hpp"

#include <jpeglib.h>

#include <cstddef>
#include <cstdio>
#include <cstdlib>

#include "image/test_support.hpp"

namespace relumine {
namespace {

using test::contains;
using test::image_error;
using Bytes = std::vector<std::uint8_t>;

struct JpegSource {
    int width = 16, height = 16;
    Bytes pixel;  // one, repeated everywhere
    J_COLOR_SPACE space = JCS_RGB;
    bool progressive = false;
    bool adobe = false;  // write the marker that makes CMYK inverted
};

Bytes write_jpeg(const JpegSource& source) {
    jpeg_compress_struct info{};
    jpeg_error_mgr errors{};
    info.err = jpeg_std_error(&errors);
    jpeg_create_compress(&info);
    unsigned char* memory = nullptr;
    unsigned long size = 0;
    jpeg_mem_dest(&info, &memory, &size);
    info.image_width = static_cast<JDIMENSION>(source.width);
    info.image_height = static_cast<JDIMENSION>(source.height);
    info.input_components = static_cast<int>(source.pixel.size());
    info.in_color_space = source.space;
    jpeg_set_defaults(&info);
    jpeg_set_quality(&info, 100, TRUE);
    if (source.progressive) jpeg_simple_progression(&info);
    if (source.space == JCS_CMYK) info.write_Adobe_marker = source.adobe ? TRUE : FALSE;
    jpeg_start_compress(&info, TRUE);
    Bytes row;
    for (int x = 0; x < source.width; ++x) row.insert(row.end(), source.pixel.begin(), source.pixel.end());
    for (int y = 0; y < source.height; ++y) {
        JSAMPROW pointer = row.data();
        jpeg_write_scanlines(&info, &pointer, 1);
    }
    jpeg_finish_compress(&info);
    jpeg_destroy_compress(&info);
    Bytes out(memory, memory + size);
    std::free(memory);
    return out;
}

void expect_near(const ByteImage& image, int r, int g, int b) {
    ASSERT_EQ(image.rgba8.size(), static_cast<std::size_t>(4 * image.width * image.height));
    const std::array<int, 4> expected{r, g, b, 255};
    for (std::size_t i = 0; i < image.rgba8.size(); ++i) ASSERT_NEAR(image.rgba8[i], expected[i % 4], 2) << i;
}

TEST(Jpeg, Rgb) { expect_near(decode_byte_image(write_jpeg({16, 9, {200, 100, 50}}), "t"), 200, 100, 50); }

TEST(Jpeg, Progressive) {
    expect_near(decode_jpeg(write_jpeg({33, 17, {10, 250, 90}, JCS_RGB, true}), "t"), 10, 250, 90);
}

TEST(Jpeg, GreyIsReplicated) {
    expect_near(decode_jpeg(write_jpeg({5, 5, {90}, JCS_GRAYSCALE}), "t"), 90, 90, 90);
}

TEST(Jpeg, CmykOfAdobeIsStoredInverted) {
    expect_near(decode_jpeg(write_jpeg({8, 8, {255, 128, 0, 200}, JCS_CMYK, false, true}), "t"), 200, 100, 0);
}

TEST(Jpeg, CmykWithoutTheMarkerIsInk) {
    expect_near(decode_jpeg(write_jpeg({8, 8, {0, 127, 255, 55}, JCS_CMYK, false, false}), "t"), 200, 100, 0);
}

TEST(Jpeg, BlankPicturesAreDenseAndStillRead) {
    const Bytes jpeg = write_jpeg({2048, 2048, {90}, JCS_GRAYSCALE, true});
    EXPECT_LT(jpeg.size(), 20000u);
    EXPECT_EQ(decode_jpeg(jpeg, "t").width, 2048);
}

TEST(Jpeg, GarbageBetweenMarkersDoesNoHarm) {
    Bytes jpeg = write_jpeg({16, 16, {200, 100, 50}});
    jpeg.insert(jpeg.begin() + 20, {1, 2, 3});  // behind the JFIF marker: SOI (2) + APP0 (18)
    expect_near(decode_jpeg(jpeg, "t"), 200, 100, 50);
}

TEST(Jpeg, EveryTruncationIsAnError) {
    for (const bool progressive : {false, true}) {
        const Bytes jpeg = write_jpeg({40, 40, {200, 100, 50}, JCS_RGB, progressive});
        for (std::size_t length = 0; length < jpeg.size(); ++length)
            (void)image_error([&] { (void)decode_byte_image(std::span(jpeg).first(length), "t.jpg"); });
    }
}

/// Offset of the start-of-frame marker's payload: length (2), precision (1), height (2), width (2).
std::size_t frame_header(const Bytes& jpeg) {
    for (std::size_t i = 2; i + 4 < jpeg.size(); i += 2u + (std::size_t{jpeg[i + 2]} << 8 | jpeg[i + 3]))
        if (jpeg[i + 1] == 0xc0) return i + 2;
    ADD_FAILURE() << "no frame header";
    return 2;
}

TEST(Jpeg, HugeZeroAndOddHeadersAreRefused) {
    Bytes jpeg = write_jpeg({16, 16, {200, 100, 50}});
    const std::size_t frame = frame_header(jpeg);
    const auto with = [&](std::size_t offset, std::initializer_list<std::uint8_t> values) {
        Bytes changed = jpeg;
        std::copy(values.begin(), values.end(),
                  changed.begin() + static_cast<std::ptrdiff_t>(frame + offset));
        return image_error([&] { (void)decode_jpeg(changed, "t.jpg"); });
    };
    EXPECT_TRUE(
        contains(with(3, {0xff, 0xdc, 0xff, 0xdc}), "65500 x 65500"));  // libjpeg's own limit is 65500
    EXPECT_TRUE(contains(with(3, {0x20, 0, 0x20, 0}), "expected at least 61008 bytes for so many pixels"));
    EXPECT_TRUE(contains(with(3, {0, 0}), "t.jpg: expected an undamaged JPEG file, found"));
    EXPECT_TRUE(contains(with(2, {12}), "t.jpg: expected an undamaged JPEG file, found"));
    EXPECT_TRUE(
        contains(with(3, {1, 0}), "t.jpg: expected an undamaged JPEG file, found"));  // 256 rows, 16 there
}

}  // namespace
}  // namespace relumine
