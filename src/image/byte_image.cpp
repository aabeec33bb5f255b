// SPDX-License-Identifier: Apache-2.0
// Decoding pictures of small integers by content.
#include "image/byte_image.hpp"

#include "image/check.hpp"
#include "image/jpeg.hpp"
#include "image/png.hpp"
#include "image/webp.hpp"

namespace relumine {

ByteImage decode_byte_image(std::span<const std::uint8_t> encoded, const std::string& name) {
    if (is_png(encoded)) return decode_png(encoded, name);
    if (is_jpeg(encoded)) return decode_jpeg(encoded, name);
    if (is_webp(encoded)) return decode_webp(encoded, name);
    fail_image(name, "a PNG, JPEG or WebP picture", encoded.empty() ? "no bytes" : "other content");
}

}  // namespace relumine
