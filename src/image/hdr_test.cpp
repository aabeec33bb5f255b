// SPDX-License-Identifier: Apache-2.0
// Radiance pictures written by hand, flat and in both run-length codings.
#include "image/hdr.hpp"

#include "image/test_support.hpp"

namespace relumine {
namespace {

using test::bytes_of;
using test::contains;
using test::image_error;
using Bytes = std::vector<std::uint8_t>;

Bytes hdr(const std::string& size, const Bytes& pixels,
          const std::string& variables = "FORMAT=32-bit_rle_rgbe\n") {
    Bytes file = bytes_of("#?RADIANCE\n# made by hand\n" + variables + "\n" + size + "\n");
    file.insert(file.end(), pixels.begin(), pixels.end());
    return file;
}

std::vector<float> pixels_of(const Bytes& file) { return decode_hdr(file, "t").layer()->pixels; }

TEST(Hdr, FlatPixels) {
    EXPECT_EQ(pixels_of(hdr("-Y 1 +X 2", {128, 64, 32, 129, 200, 100, 50, 136})),
              (std::vector<float>{1, 0.5f, 0.25f, 200, 100, 50}));
}

TEST(Hdr, ExponentZeroIsBlack) {
    EXPECT_EQ(pixels_of(hdr("-Y 1 +X 1", {128, 64, 32, 0})), (std::vector<float>{0, 0, 0}));
}

TEST(Hdr, RowsGoDown) {
    const Image image = decode_hdr(hdr("-Y 2 +X 1", {1, 0, 0, 136, 2, 0, 0, 136}), "t");
    EXPECT_EQ(image.height, 2);
    EXPECT_EQ(image.rgb(0, 1)[0], 2);
}

TEST(Hdr, LinesMayEndInCarriageReturns) {
    Bytes file = bytes_of("#?RGBE\r\nFORMAT=32-bit_rle_rgbe\r\n\r\n-Y 1 +X 1\r\n");
    file.insert(file.end(), {9, 8, 7, 136});
    EXPECT_EQ(pixels_of(file), (std::vector<float>{9, 8, 7}));
}

/// A row of 10 pixels: red 1…10 as a stretch, green 5 as a run, blue 0 as two runs, exponent such that 1
/// is 1.
Bytes planar_row() {
    return {2, 2, 0, 10, 10, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 138, 5, 130, 0, 136, 0, 138, 136};
}

TEST(Hdr, PlanarRuns) {
    Bytes rows = planar_row();
    const Bytes again = planar_row();
    rows.insert(rows.end(), again.begin(), again.end());
    const Image image = decode_hdr(hdr("-Y 2 +X 10", rows), "t");
    for (int x = 0; x < 10; ++x)
        EXPECT_EQ(image.rgb(x, 1), (std::array<float, 3>{static_cast<float>(x + 1), 5, 0}));
}

TEST(Hdr, OldRunsRepeatTheLastPixel) {
    const std::vector<float> pixels = pixels_of(hdr("-Y 1 +X 6", {7, 8, 9, 136, 1, 1, 1, 4, 3, 2, 1, 136}));
    EXPECT_EQ(pixels[3 * 4], 7);
    EXPECT_EQ(pixels[3 * 5], 3);
}

TEST(Hdr, OldRunsOfRunsCountInBase256) {
    Bytes rows{7, 8, 9, 136, 1, 1, 1, 2, 1, 1, 1, 1, 3, 3, 3, 136};  // 1 + 2 + 256 + 1
    const std::vector<float> pixels = pixels_of(hdr("-Y 1 +X 260", rows));
    EXPECT_EQ(pixels[3 * 258], 7);
    EXPECT_EQ(pixels[3 * 259], 3);
}

TEST(Hdr, DamagedFilesSayWhatIsWrong) {
    const auto message = [](const Bytes& file) {
        return image_error([&] { (void)decode_hdr(file, "a.hdr"); });
    };
    EXPECT_TRUE(contains(message(hdr("-Y 1 +X 1", {1, 2, 3, 4}, "FORMAT=32-bit_rle_xyze\n")),
                         "a.hdr: expected FORMAT=32-bit_rle_rgbe, found \"FORMAT=32-bit_rle_xyze\""));
    EXPECT_TRUE(contains(message(hdr("+X 1 -Y 1", {1, 2, 3, 4})), "expected \"-Y height +X width\""));
    EXPECT_TRUE(contains(message(hdr("-Y nan +X 1", {1, 2, 3, 4})), "found \"-Y nan +X 1\""));
    EXPECT_TRUE(contains(message(hdr("-Y 1 +X 1 ", {1, 2, 3, 4})), "found \"-Y 1 +X 1 \""));
    EXPECT_TRUE(contains(message(hdr("-Y 0 +X 1", {1, 2, 3, 4})), "found 1 x 0 pixels"));
    EXPECT_TRUE(contains(message(hdr("-Y 60000 +X 60000", {1, 2, 3, 4})), "found 60000 x 60000 pixels"));
    EXPECT_TRUE(
        contains(message(hdr("-Y 99999999999999999999 +X 1", {1, 2, 3, 4})), "\"-Y height +X width\""));
    EXPECT_TRUE(contains(message(hdr("-Y 10000 +X 10000", {1, 2, 3, 4})),
                         "expected at least 40000 bytes of pixels, found 4"));
    EXPECT_TRUE(contains(message(bytes_of("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n")), "a whole HDR header"));
    EXPECT_TRUE(contains(message(hdr("-Y 1 +X 2", {1, 1, 1, 1, 1, 1, 1, 1})),
                         "a run that fits its row"));  // of nothing
    EXPECT_TRUE(contains(message(hdr("-Y 1 +X 2", {9, 9, 9, 9, 1, 1, 1, 2})), "a run that fits its row"));
    EXPECT_TRUE(contains(message(hdr("-Y 1 +X 10", {2, 2, 0, 10, 139, 5})),
                         "expected a run of 1 to 10 pixels, found 11"));
    EXPECT_TRUE(contains(message(hdr("-Y 1 +X 10", {2, 2, 0, 10, 0, 5})), "found 0"));
}

TEST(Hdr, EveryTruncationIsAnError) {
    for (const Bytes& file :
         {hdr("-Y 1 +X 10", planar_row()), hdr("-Y 1 +X 2", {128, 64, 32, 129, 200, 100, 50, 136})})
        for (std::size_t length = 0; length < file.size(); ++length)
            (void)image_error([&] { (void)decode_hdr(std::span(file).first(length), "t"); });
}

}  // namespace
}  // namespace relumine
