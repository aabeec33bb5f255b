// SPDX-License-Identifier: Apache-2.0
// References.
#include "cli/reference.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "relumine/error.hpp"

namespace relumine::cli {
namespace {

/// The picture itself within `window`.
Image cut(const Image& image, const PixelRect& window) {
    const Layer& whole = *image.layer();
    const std::size_t channels = whole.channels.size();
    Layer part{"", whole.channels, {}};
    for (int y = window.y0; y < window.y1; ++y) {
        const auto row =
            whole.pixels.begin()
            + static_cast<std::ptrdiff_t>((static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width)
                                           + static_cast<std::size_t>(window.x0))
                                          * channels);
        part.pixels.insert(
            part.pixels.end(), row,
            row + static_cast<std::ptrdiff_t>(static_cast<std::size_t>(window.width()) * channels));
    }
    return {window.width(), window.height(), window, image.width, image.height, {std::move(part)}, {}};
}

}  // namespace

Image read_reference(const std::string& path, const PictureFrame& frame) {
    Image image = read_image(path);
    const PixelRect& window = frame.window;
    if (image.width == window.width() && image.height == window.height()) return image;
    if (image.width == frame.width && image.height == frame.height && image.layer())
        return cut(image, window);
    throw ImageError(fmt::format("{}: expected a reference of {} x {} pixels, found {} x {}", path,
                                 window.width(), window.height(), image.width, image.height));
}

nlohmann::ordered_json reference_json(const std::string& path, const Comparison& c) {
    return {{"file", path},       {"relative_l1", c.relative_l1}, {"rmse", c.rmse},
            {"relmse", c.relmse}, {"mean_ratio", c.mean_ratio},   {"non_finite_pixels", c.non_finite_pixels}};
}

nlohmann::ordered_json coverage_json(const ErrorCoverage& c) {
    return {{"pixels", c.pixels}, {"one_sigma", c.one_sigma}, {"two_sigma", c.two_sigma}};
}

}  // namespace relumine::cli
