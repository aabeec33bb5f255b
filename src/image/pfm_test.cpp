// SPDX-License-Identifier: Apache-2.0
// Portable float maps, byte by byte.
#include "image/pfm.hpp"

#include <bit>
#include <cmath>
#include <limits>

#include "image/test_support.hpp"

namespace relumine {
namespace {

using test::bytes_of;
using test::contains;
using test::image_error;

TEST(Pfm, RoundTripIsExact) {
    const Image image = test::noise_picture(7, 5);
    const Image read = decode_pfm(encode_pfm(image), "t");
    EXPECT_EQ(read.width, 7);
    EXPECT_EQ(read.height, 5);
    EXPECT_EQ(read.window, (PixelRect{0, 0, 7, 5}));
    EXPECT_EQ(read.layer()->pixels, image.layer()->pixels);
    EXPECT_EQ(read.layer()->channels, (std::vector<std::string>{"R", "G", "B"}));
}

TEST(Pfm, GreyRoundTripIsExact) {
    const Image image = make_picture(3, 2, {"Y"}, {1, 2, 3, 4, 5, 6});
    const Image read = decode_pfm(encode_pfm(image), "t");
    EXPECT_EQ(read.layer()->pixels, image.layer()->pixels);
    EXPECT_EQ(read.rgb(2, 1), (std::array<float, 3>{6, 6, 6}));
}

TEST(Pfm, BottomRowComesFirst) {
    const std::vector<std::uint8_t> bytes = encode_pfm(make_picture(1, 2, {"Y"}, {1, 2}));
    EXPECT_EQ(bytes, bytes_of(std::string("Pf\n1 2\n-1.0\n") + std::string("\0\0\0\x40", 4)
                              + std::string("\0\0\x80\x3f", 4)));
}

TEST(Pfm, BigEndianWithAScale) {
    const Image read = decode_pfm(bytes_of(std::string("Pf 1 1 2.5\n") + std::string("\x40\0\0\0", 4)), "t");
    EXPECT_EQ(read.layer()->pixels, std::vector<float>{5});
}

TEST(Pfm, NegativeAndNonFinitePixelsAreNotAltered) {
    const float inf = std::numeric_limits<float>::infinity();
    const Image image = make_picture(2, 2, {"Y"}, {-1, inf, -inf, std::nanf("")});
    const std::vector<float> read = decode_pfm(encode_pfm(image), "t").layer()->pixels;
    EXPECT_EQ(read[0], -1);
    EXPECT_EQ(read[1], inf);
    EXPECT_EQ(read[2], -inf);
    EXPECT_TRUE(std::isnan(read[3]));
}

TEST(Pfm, DamagedHeadersSayWhatIsWrong) {
    const auto message = [](const std::string& text) {
        return image_error([&] { (void)decode_pfm(bytes_of(text), "a.pfm"); });
    };
    EXPECT_EQ(message("PF\n1 1\nnan\nxxxxxxxxxxxx"),
              "a.pfm: expected a finite scale other than 0, found \"nan\"");
    EXPECT_TRUE(contains(message("PF\n1 1\n0\nxxxxxxxxxxxx"), "scale other than 0"));
    EXPECT_TRUE(contains(message("PF\n1 1\n1e99\nxxxxxxxxxxxx"), "found \"1e99\""));
    EXPECT_TRUE(contains(message("PF\n1 1\n-inf\nxxxxxxxxxxxx"), "found \"-inf\""));
    EXPECT_TRUE(contains(message("PF\nnan 1\n-1\n"), "a width and a height in pixels, found \"nan\""));
    EXPECT_TRUE(contains(message("PF\n1.5 1\n-1\n"), "found \"1.5\""));
    EXPECT_TRUE(contains(message("PF\n0 4\n-1\n"), "found 0 x 4 pixels"));
    EXPECT_TRUE(contains(message("PF\n-3 4\n-1\n"), "found -3 x 4 pixels"));
    EXPECT_TRUE(contains(message("PF\n65537 1\n-1\n"), "found 65537 x 1 pixels"));
    EXPECT_TRUE(contains(message("PF\n65536 65536\n-1\n"), "found 65536 x 65536 pixels"));
    EXPECT_TRUE(contains(message("PF\n99999999999999999999 1\n-1\n"), "found \"99999999999999999999\""));
    EXPECT_TRUE(
        contains(message("PF\n16384 16384\n-1\nabc"), "expected 3221225472 bytes of pixels, found 3"));
    EXPECT_TRUE(contains(message("PF\n4 4"), "found the end of the header"));
}

}  // namespace
}  // namespace relumine
