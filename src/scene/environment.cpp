// SPDX-License-Identifier: Apache-2.0
// Reads lat-long environments.
#include <fmt/format.h>

#include <cmath>

#include "base/message.hpp"
#include "relumine/error.hpp"
#include "relumine/image.hpp"
#include "scene/readers.hpp"

namespace relumine {
namespace {

void check_shape(const Image& image, const std::string& path) {
    constexpr int max_side = 32768;
    if (image.width >= 2 && image.height >= 1 && image.width <= max_side && image.height <= max_side
        && image.layer() != nullptr)
        return;
    throw ImageError{expected_found(
        path, fmt::format("an RGB picture of 2 × 1 to {0} × {0} pixels", max_side),
        image.layer() == nullptr ? "no colour channels" : fmt::format("{} × {}", image.width, image.height))};
}

bool is_radiance(Spectrum s) { return is_finite(s) && s.r >= 0 && s.g >= 0 && s.b >= 0; }

float clean(float x) { return std::isfinite(x) && x > 0 ? x : 0; }

}  // namespace

Environment read_environment(const std::string& path, std::vector<std::string>& warnings) {
    const Image image = read_image(path);
    check_shape(image, path);
    if (image.width != 2 * image.height)
        warnings.push_back(
            fmt::format("{}: a lat-long environment is twice as wide as high; this one has {} × {} pixels",
                        path, image.width, image.height));
    Environment environment{image.width, image.height, {}, 0};
    environment.radiance.reserve(static_cast<std::size_t>(image.width)
                                 * static_cast<std::size_t>(image.height));
    std::size_t damaged = 0;
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            const auto [r, g, b] = image.rgb(x, y);
            const bool good = is_radiance({r, g, b});
            damaged += good ? 0 : 1;
            environment.radiance.push_back(good ? Spectrum{r, g, b} : Spectrum{clean(r), clean(g), clean(b)});
        }
    }
    if (damaged > 0)
        warnings.push_back(
            fmt::format("{}: {} texels were negative or not finite and became 0", path, damaged));
    return environment;
}

}  // namespace relumine
