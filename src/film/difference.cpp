// SPDX-License-Identifier: Apache-2.0
// A picture of the signed difference: equal steps of difference look equally large, both signs equally
// strong.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/message.hpp"
#include "base/oklab.hpp"
#include "relumine/compare.hpp"
#include "relumine/error.hpp"

namespace relumine {
namespace {

Spectrum pixel(const Image& image, int x, int y) {
    const std::array<float, 3> rgb = image.rgb(x, y);
    return {rgb[0], rgb[1], rgb[2]};
}

/// From blue (−1) over white (0) to red (1): lightness falls in step with |t|, straight lines in Oklab.
Spectrum diverging_colour(float t) {
    constexpr float white = 1, deep = 0.45f;  // lightness
    const float strength = std::min(std::abs(t), 1.0f);
    const float lightness = white + (deep - white) * strength;
    return t > 0 ? rgb_from_oklab(lightness, 0.165f * strength, 0.09f * strength)
                 : rgb_from_oklab(lightness, -0.02f * strength, -0.185f * strength);
}

void check_pair(const Image& image, const Image& reference) {
    if (!image.layer() || !reference.layer())
        throw ImageError{expected_found(image.layer() ? "reference" : "image",
                                        "a layer \"\", the picture itself", "only other layers")};
    if (image.width == reference.width && image.height == reference.height) return;
    throw ImageError{expected_found(
        "image", fmt::format("{} x {} pixels like the reference", reference.width, reference.height),
        fmt::format("{} x {} pixels", image.width, image.height))};
}

/// Luminance of the image less that of the reference; NaN where either is not finite.
std::vector<float> differences(const Image& image, const Image& reference) {
    std::vector<float> result;
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) {
            const float difference = luminance(pixel(image, x, y)) - luminance(pixel(reference, x, y));
            result.push_back(std::isfinite(difference) ? difference : std::nanf(""));
        }
    return result;
}

/// The 99th percentile of |difference|, or 1 where that is 0.
double automatic_scale(const std::vector<float>& signed_differences) {
    std::vector<float> sizes;
    for (const float difference : signed_differences)
        if (!std::isnan(difference)) sizes.push_back(std::abs(difference));
    if (sizes.empty()) return 1;
    const auto rank = static_cast<std::ptrdiff_t>(0.99 * static_cast<double>(sizes.size() - 1));
    std::nth_element(sizes.begin(), sizes.begin() + rank, sizes.end());
    const float percentile = sizes[static_cast<std::size_t>(rank)];
    return percentile > 0 ? static_cast<double>(percentile) : 1;
}

}  // namespace

Image signed_difference(const Image& image, const Image& reference, double scale) {
    if (!std::isfinite(scale))
        throw SettingsError{
            expected_found("scale of the difference", "a finite number", fmt::format("{}", scale))};
    check_pair(image, reference);
    const std::vector<float> difference = differences(image, reference);
    const double full = scale > 0 ? scale : automatic_scale(difference);

    Image picture{image.width, image.height, image.window, image.frame_width, image.frame_height, {}, {}};
    picture.metadata["difference_scale"] = fmt::format("{}", full);
    Layer& layer = picture.layers.emplace_back(Layer{"", {"R", "G", "B"}, {}});
    for (const float d : difference) {
        const Spectrum green{0, 1, 0};
        const Spectrum colour =
            std::isnan(d) ? green : diverging_colour(static_cast<float>(static_cast<double>(d) / full));
        layer.pixels.insert(layer.pixels.end(), {colour.r, colour.g, colour.b});
    }
    return picture;
}

}  // namespace relumine
