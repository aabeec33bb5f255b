// SPDX-License-Identifier: Apache-2.0
// From radiance to the bytes of a picture for the screen.
#include "image/quantize.hpp"

#include <algorithm>
#include <cmath>

#include "base/hash.hpp"
#include "image/srgb.hpp"

namespace relumine {
namespace {

/// The sRGB level in [0, 255] of linear light; not yet an integer.
double encoded_level(double linear) {
    if (!(linear > 0)) return 0;  // negative or NaN
    const double level = 255 * srgb_from_linear(std::min(linear, 1.0));
    constexpr double rounding = 1e-3;  // of a level; more than storing pixels as floats can add
    const double nearest = std::round(level);
    return std::abs(level - nearest) < rounding ? nearest : level;
}

/// A number in [0, 1) that belongs to a channel of a pixel of the frame.
double dither(int x, int y, std::size_t channel) {
    const auto key =
        static_cast<std::uint64_t>(static_cast<std::uint32_t>(x)) << 32 | static_cast<std::uint32_t>(y);
    return unit_float(static_cast<std::uint32_t>(hash(key, channel) >> 32));
}

}  // namespace

std::vector<std::uint8_t> quantize(const Image& image, float exposure) {
    const double gain = std::exp2(static_cast<double>(exposure));
    std::vector<std::uint8_t> bytes;
    bytes.reserve(std::size_t{3} * static_cast<std::size_t>(image.width)
                  * static_cast<std::size_t>(image.height));
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) {
            const std::array<float, 3> rgb = image.rgb(x, y);
            for (std::size_t c = 0; c < 3; ++c) {
                const double noise =
                    dither(image.window.x0 + x, image.window.y0 + y, c);  // a crop keeps its noise
                bytes.push_back(
                    static_cast<std::uint8_t>(encoded_level(gain * static_cast<double>(rgb[c])) + noise));
            }
        }
    return bytes;
}

}  // namespace relumine
