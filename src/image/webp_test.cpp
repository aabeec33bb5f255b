// SPDX-License-Identifier: Apache-2.0
// WebP: lossless pictures come back as they were; damage is refused.
#include "image/webp.hpp"

#include <gtest/gtest.h>
#include <webp/encode.h>

#include "image/test_support.hpp"

namespace relumine {
namespace {

using Bytes = std::vector<std::uint8_t>;

/// A 16-wide lossless picture of a gradient with alpha.
Bytes write_webp(const Bytes& rgba) {
    std::uint8_t* memory = nullptr;
    const int height = static_cast<int>(rgba.size() / 64);
    const std::size_t size = WebPEncodeLosslessRGBA(rgba.data(), 16, height, 64, &memory);
    Bytes out(memory, memory + size);
    WebPFree(memory);
    return out;
}

Bytes gradient() {
    Bytes rgba;
    for (int i = 0; i < 16 * 8; ++i)
        for (const int value : {2 * i, 255 - i, 7 * i % 256, 128 + i})
            rgba.push_back(static_cast<std::uint8_t>(value));
    return rgba;
}

TEST(Webp, LosslessPicturesComeBackAsTheyWere) {
    const ByteImage image = decode_byte_image(write_webp(gradient()), "picture");
    EXPECT_EQ(image.width, 16);
    EXPECT_EQ(image.height, 8);
    EXPECT_EQ(image.rgba8, gradient());
}

TEST(Webp, CutFilesAreRefused) {
    const Bytes whole = write_webp(gradient());
    for (const std::size_t size : {std::size_t{12}, std::size_t{20}, whole.size() / 2, whole.size() - 4}) {
        const Bytes cut(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
        const std::string message = test::image_error([&] { (void)decode_byte_image(cut, "picture"); });
        EXPECT_TRUE(test::contains(message, "picture: expected")) << size << ": " << message;
    }
}

TEST(Webp, SizesThatTheDataDoNotHoldAreRefused) {
    Bytes claimed = write_webp(gradient());
    for (const std::size_t at : {21u, 22u, 23u}) claimed[at] = 0xff;  // 14 bits each of width and height
    EXPECT_NE(test::image_error([&] { (void)decode_byte_image(claimed, "picture"); }), "");
}

}  // namespace
}  // namespace relumine
