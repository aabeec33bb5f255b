// SPDX-License-Identifier: Apache-2.0
// What a picture expects of its own error, and whether it was right.
#include <numbers>

#include "film/compare.hpp"
#include "relumine/compare.hpp"

namespace relumine {
namespace {

using namespace compare;

double luminance_of(const Rgb& c) { return 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2]; }

/// One sigma of luminance; 0 where nothing is said.
double sigma_at(const Image& image, double luminance, std::size_t pixel) {
    const Layer* layer = image.layer("error");
    return layer ? luminance * layer->pixels[pixel] : 0;
}

template <typename Use>
void for_each_pixel(const Image& image, const Use& use) {
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x)
            use(x, y,
                static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width)
                    + static_cast<std::size_t>(x));
}

}  // namespace

std::optional<double> predicted_relative_l1(const Image& image) {
    if (!image.layer("error")) return {};
    const Picture picture(image, "image");
    double error = 0, all = 0;
    for_each_pixel(image, [&](int x, int y, std::size_t pixel) {
        const double l = luminance_of(picture.at(x, y));
        const double sigma = sigma_at(image, l, pixel);
        if (!std::isfinite(l) || !std::isfinite(sigma)) return;
        error += sigma;
        all += l;
    });
    return std::sqrt(2 / std::numbers::pi) * ratio(error, all);
}

std::optional<ErrorCoverage> error_coverage(const Image& image, const Image& reference) {
    if (!image.layer("error")) return {};
    const Picture picture(image, "image"), expected(reference, "reference");
    check_same_size(picture, expected, "image");
    ErrorCoverage coverage;
    std::size_t within_one = 0, within_two = 0;
    for_each_pixel(image, [&](int x, int y, std::size_t pixel) {
        const double l = luminance_of(picture.at(x, y)), l_ref = luminance_of(expected.at(x, y));
        const double own = sigma_at(image, l, pixel);
        if (!std::isfinite(l) || !std::isfinite(l_ref) || !(own > 0)) return;
        const double sigma = std::hypot(own, sigma_at(reference, l_ref, pixel)), off = std::abs(l - l_ref);
        ++coverage.pixels;
        within_one += off <= sigma ? 1 : 0;
        within_two += off <= 2 * sigma ? 1 : 0;
    });
    if (coverage.pixels == 0) return coverage;
    coverage.one_sigma = static_cast<double>(within_one) / static_cast<double>(coverage.pixels);
    coverage.two_sigma = static_cast<double>(within_two) / static_cast<double>(coverage.pixels);
    return coverage;
}

}  // namespace relumine
