// SPDX-License-Identifier: Apache-2.0
// Pixel filters.
#include "integrators/pixel_filter.hpp"

namespace relumine {
namespace {

constexpr float radius = 1.5f;  // pixels

/// The four-term Blackman-Harris window over t in [0, 1].
double blackman_harris(double t) {
    const double phi = 2 * 3.14159265358979323846 * t;
    return 0.35875 - 0.48829 * std::cos(phi) + 0.14128 * std::cos(2 * phi) - 0.01168 * std::cos(3 * phi);
}

}  // namespace

PixelFilter::PixelFilter(PixelFilterKind kind) : kind_(kind) {
    double sum = 0;
    std::array<double, steps + 1> running{};
    for (std::size_t i = 0; i < steps; ++i)
        running[i + 1] = sum += blackman_harris((static_cast<double>(i) + 0.5) / static_cast<double>(steps));
    for (std::size_t i = 0; i <= steps; ++i) cdf_[i] = static_cast<float>(running[i] / sum);
}

float PixelFilter::offset(float u) const {
    const auto above = std::upper_bound(cdf_.begin() + 1, cdf_.end() - 1, u);
    const auto step = static_cast<std::size_t>(above - cdf_.begin()) - 1;
    const float fraction = (u - cdf_[step]) / (cdf_[step + 1] - cdf_[step]);
    return radius * (2 * (static_cast<float>(step) + fraction) / static_cast<float>(steps) - 1);
}

Point2 PixelFilter::position(Point2 u) const {
    if (kind_ == PixelFilterKind::center) return {0.5f, 0.5f};
    if (kind_ == PixelFilterKind::box) return u;
    return {0.5f + offset(u.x), 0.5f + offset(u.y)};
}

}  // namespace relumine
