// SPDX-License-Identifier: Apache-2.0
// What the comparisons share: pixels in double precision, checks of sizes, ratios that survive a black
// reference.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <string_view>

#include "base/message.hpp"
#include "relumine/error.hpp"
#include "relumine/image.hpp"

namespace relumine::compare {

using Rgb = std::array<double, 3>;
inline constexpr double infinite = std::numeric_limits<double>::infinity();
inline constexpr double dark = 0.05;  // of the picture's mean: no block is measured against less

inline void check(bool good, std::string_view where, std::string_view expected, double found) {
    if (!good) throw SettingsError{expected_found(where, expected, fmt::format("{}", found))};
}

inline std::string size_text(int width, int height) { return fmt::format("{} x {} pixels", width, height); }

/// The picture itself, pixel by pixel in double precision.
class Picture {
  public:
    Picture(const Image& image, const std::string& what) : image_(&image) {
        if (image.width < 1 || image.height < 1 || !image.layer())
            throw ImageError{expected_found(what, "a layer \"\", the picture itself",
                                            fmt::format("{} other layers", image.layers.size()))};
        layer_ = image.layer();
    }
    [[nodiscard]] int width() const { return image_->width; }
    [[nodiscard]] int height() const { return image_->height; }
    [[nodiscard]] Rgb at(int x, int y) const {
        const std::size_t channels = layer_->channels.size();
        const auto row = static_cast<std::size_t>(y) * static_cast<std::size_t>(width());
        const float* pixel = layer_->pixels.data() + (row + static_cast<std::size_t>(x)) * channels;
        if (channels < 3) return {*pixel, *pixel, *pixel};
        return {pixel[0], pixel[1], pixel[2]};
    }

  private:
    const Image* image_;
    const Layer* layer_ = nullptr;
};

inline void check_same_size(const Picture& picture, const Picture& reference, const std::string& what) {
    if (picture.width() == reference.width() && picture.height() == reference.height()) return;
    throw ImageError{expected_found(what,
                                    size_text(reference.width(), reference.height()) + " like the reference",
                                    size_text(picture.width(), picture.height()))};
}

inline bool is_finite(const Rgb& c) {
    return std::isfinite(c[0]) && std::isfinite(c[1]) && std::isfinite(c[2]);
}
inline double sum(const Rgb& c) { return c[0] + c[1] + c[2]; }
inline void add(Rgb& to, const Rgb& c, double factor = 1) {
    for (std::size_t i = 0; i < 3; ++i) to[i] += factor * c[i];
}
inline Rgb scaled(Rgb c, double factor) {
    for (double& value : c) value *= factor;
    return c;
}
inline double abs_difference(const Rgb& a, const Rgb& b) {
    return std::abs(a[0] - b[0]) + std::abs(a[1] - b[1]) + std::abs(a[2] - b[2]);
}

/// x / y with 0 / 0 = `none` and x / 0 = ∞.
inline double ratio(double x, double y, double none = 0) {
    if (y != 0) return x / y;
    return x == 0 ? none : infinite;
}

/// Relative difference of mean colours; `floor` keeps dark blocks from dominating.
inline double block_difference(const Rgb& mean, const Rgb& mean_reference, double floor) {
    return ratio(abs_difference(mean, mean_reference), std::max(sum(mean_reference), floor));
}

}  // namespace relumine::compare
