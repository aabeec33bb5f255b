// SPDX-License-Identifier: Apache-2.0
// WebP by libwebp, which decodes into memory that we have sized.
#include "image/webp.hpp"

#include <webp/decode.h>

#include "image/check.hpp"

namespace relumine {

bool is_webp(std::span<const std::uint8_t> bytes) {
    return bytes.size() >= 12 && starts_with(bytes, "RIFF") && starts_with(bytes.subspan(8), "WEBP");
}

ByteImage decode_webp(std::span<const std::uint8_t> encoded, const std::string& name) {
    WebPBitstreamFeatures features{};
    if (WebPGetFeatures(encoded.data(), encoded.size(), &features) != VP8_STATUS_OK)
        fail_image(name, "a valid WebP picture", "a damaged header");
    if (features.has_animation != 0) fail_image(name, "a WebP picture", "a WebP animation");
    check_image_size(features.width, features.height, name);
    ByteImage image{features.width, features.height, {}, {}};
    const std::size_t stride = 4 * static_cast<std::size_t>(image.width);
    image.rgba8.resize(stride * static_cast<std::size_t>(image.height));
    if (WebPDecodeRGBAInto(encoded.data(), encoded.size(), image.rgba8.data(), image.rgba8.size(),
                           static_cast<int>(stride))
        == nullptr)
        fail_image(name, "a valid WebP picture", "damaged or missing data");
    return image;
}

}  // namespace relumine
