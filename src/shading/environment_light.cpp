// SPDX-License-Identifier: Apache-2.0
// Light from infinity.
#include "shading/environment_light.hpp"

#include <algorithm>
#include <numeric>
#include <span>

namespace relumine {
namespace {

float mean_of_channels(Spectrum s) { return (s.r + s.g + s.b) / 3; }

/// cos θ at the border above row `y`.
double border_cosine(int y, int height) {
    return std::cos(static_cast<double>(y) * 3.14159265358979323846 / height);
}

/// The mean of the bilinear interpolant over each texel's area: a [1 6 1]/8 kernel along both axes.
std::vector<float> interpolated_means(const Environment& e) {
    const auto width = static_cast<std::size_t>(e.width), height = static_cast<std::size_t>(e.height);
    std::vector<float> means(width * height);
    const auto horizontal = [&](std::size_t x, std::size_t y) {
        const Spectrum* row = &e.radiance[y * width];
        return (mean_of_channels(row[(x + width - 1) % width]) + 6 * mean_of_channels(row[x])
                + mean_of_channels(row[(x + 1) % width]))
               / 8;
    };
    for (std::size_t y = 0; y < height; ++y)
        for (std::size_t x = 0; x < width; ++x) {
            const std::size_t above = y == 0 ? 0 : y - 1, below = std::min(y + 1, height - 1);
            means[y * width + x] = (horizontal(x, above) + 6 * horizontal(x, y) + horizontal(x, below)) / 8;
        }
    return means;
}

/// The greatest value of the bilinear interpolant within each texel, or more: of the 3 × 3 texels around.
std::vector<float> interpolated_maxima(const Environment& e) {
    const auto width = static_cast<std::size_t>(e.width), height = static_cast<std::size_t>(e.height);
    std::vector<float> maxima(width * height);
    for (std::size_t y = 0; y < height; ++y)
        for (std::size_t x = 0; x < width; ++x) {
            float most = 0;
            for (std::size_t j = y == 0 ? 0 : y - 1; j <= std::min(y + 1, height - 1); ++j)
                for (const std::size_t i : {(x + width - 1) % width, x, (x + 1) % width})
                    most = std::max(most, mean_of_channels(e.radiance[j * width + i]));
            maxima[y * width + x] = most;
        }
    return maxima;
}

/// The element of a cumulative distribution (from 0 to 1) that `u` falls into, and where in it.
struct Drawn {
    std::size_t element;
    float fraction;  // [0, 1)
};
Drawn draw(std::span<const float> cdf, float u) {
    const auto above = std::upper_bound(cdf.begin() + 1, cdf.end() - 1, u);
    const auto element = static_cast<std::size_t>(above - cdf.begin()) - 1;
    const float width = cdf[element + 1] - cdf[element];
    return {element, width > 0 ? std::clamp((u - cdf[element]) / width, 0.0f, 0x1.fffffep-1f) : 0.0f};
}

/// Writes the normalised running sum of `weights`; false where they are all zero.
bool accumulate(std::span<const double> weights, std::span<float> cdf) {
    const double total = std::accumulate(weights.begin(), weights.end(), 0.0);
    double sum = 0;
    cdf[0] = 0;
    for (std::size_t i = 0; i < weights.size(); ++i) {
        sum += weights[i];
        cdf[i + 1] = total > 0 ? static_cast<float>(sum / total) : 0.0f;
    }
    return total > 0;
}

}  // namespace

float EnvironmentLight::mean_radiance(const Environment& e) {
    double sum = 0;
    for (int y = 0; y < e.height; ++y) {
        double row = 0;
        for (int x = 0; x < e.width; ++x)
            row += mean_of_channels(e.radiance[static_cast<std::size_t>(y) * static_cast<std::size_t>(e.width)
                                               + static_cast<std::size_t>(x)]);
        sum += row * (border_cosine(y, e.height) - border_cosine(y + 1, e.height));
    }
    return static_cast<float>(sum / (2.0 * e.width));
}

EnvironmentLight::EnvironmentLight(const Environment& environment, float floor, float threshold)
    : environment_(environment), width_(environment.width), height_(environment.height) {
    const auto width = static_cast<std::size_t>(width_), height = static_cast<std::size_t>(height_);
    const std::vector<float> means = interpolated_means(environment);
    const std::vector<float> maxima = interpolated_maxima(environment);
    row_cdf_.resize(height + 1);
    texel_cdf_.resize(height * (width + 1));
    density_.resize(width * height);
    row_cosine_.resize(height + 1);
    for (int y = 0; y <= height_; ++y)
        row_cosine_[static_cast<std::size_t>(y)] = static_cast<float>(border_cosine(y, height_));

    std::vector<double> rows(height), texels(width);
    const auto solid_angle = [&](std::size_t y) {
        const int j = static_cast<int>(y);
        return 2 * 3.14159265358979323846 / width_
               * (border_cosine(j, height_) - border_cosine(j + 1, height_));
    };
    for (std::size_t y = 0; y < height; ++y) {
        for (std::size_t x = 0; x < width; ++x)
            texels[x] =
                maxima[y * width + x] > threshold ? std::max(0.0f, means[y * width + x] - floor) : 0.0f;
        rows[y] = std::accumulate(texels.begin(), texels.end(), 0.0) * solid_angle(y);
        accumulate(texels, {&texel_cdf_[y * (width + 1)], width + 1});
    }
    can_sample_ = accumulate(rows, row_cdf_);
    for (std::size_t y = 0; y < height; ++y) {
        const float* cdf = &texel_cdf_[y * (width + 1)];
        const float row_probability = row_cdf_[y + 1] - row_cdf_[y];
        for (std::size_t x = 0; x < width; ++x)
            density_[y * width + x] =
                row_probability * (cdf[x + 1] - cdf[x]) / static_cast<float>(solid_angle(y));
    }
}

EnvironmentLight::TexelCoordinates EnvironmentLight::coordinates(WorldDir direction) const {
    const Vec3 d = direction.v;
    float u = (std::atan2(d.z, d.x) + environment_.rotation) * (0.5f * inv_pi) + 0.5f;
    u -= std::floor(u);
    const float v = std::acos(std::clamp(d.y, -1.0f, 1.0f)) * inv_pi;
    return {u * static_cast<float>(width_), v * static_cast<float>(height_)};
}

Spectrum EnvironmentLight::radiance(WorldDir direction) const {
    const auto [x, y] = coordinates(direction);
    const float left = std::floor(x - 0.5f), top = std::floor(y - 0.5f);
    const float s = x - 0.5f - left, t = y - 0.5f - top;
    const auto wrap = [&](int i) {
        return static_cast<std::size_t>(i < 0 ? i + width_ : i >= width_ ? i - width_ : i);
    };
    const std::size_t x0 = wrap(static_cast<int>(left)), x1 = wrap(static_cast<int>(left) + 1);
    const std::size_t y0 = row(std::max(static_cast<int>(top), 0)),
                      y1 = row(std::min(static_cast<int>(top) + 1, height_ - 1));
    const auto& texels = environment_.radiance;
    return lerp(lerp(texels[y0 + x0], texels[y0 + x1], s), lerp(texels[y1 + x0], texels[y1 + x1], s), t);
}

float EnvironmentLight::pdf(WorldDir direction) const {
    if (!can_sample_) return 0;
    const auto [x, y] = coordinates(direction);
    const int i = std::min(static_cast<int>(x), width_ - 1), j = std::min(static_cast<int>(y), height_ - 1);
    return density_[row(j) + static_cast<std::size_t>(i)];
}

EnvironmentSample EnvironmentLight::sample(Point2 u) const {
    const auto width = static_cast<std::size_t>(width_);
    const Drawn y = draw(row_cdf_, u.y);
    const Drawn x = draw({&texel_cdf_[y.element * (width + 1)], width + 1}, u.x);
    const float cosine = lerp(row_cosine_[y.element], row_cosine_[y.element + 1], y.fraction);
    const float sine = std::sqrt(std::max(0.0f, 1 - sqr(cosine)));
    const float phi =
        2 * pi * ((static_cast<float>(x.element) + x.fraction) / static_cast<float>(width_) - 0.5f)
        - environment_.rotation;
    return {{{sine * std::cos(phi), cosine, sine * std::sin(phi)}}, density_[y.element * width + x.element]};
}

}  // namespace relumine
