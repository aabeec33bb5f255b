// SPDX-License-Identifier: Apache-2.0
// The à-trous filter.
#include "integrators/residual_filter.hpp"

#include <array>

#include "base/executor.hpp"

namespace relumine {
namespace {

constexpr std::array<float, 3> spline{3.0f / 8, 1.0f / 4, 1.0f / 16};  // B₃, from its middle outwards
constexpr float plane_tolerance = 0.5f;  // off the middle's plane, against a pixel's footprint and the step

/// How alike two points of surfaces are, [0, 1].
float likeness(const FilterGuide& a, const FilterGuide& b, float step) {
    const float cosine = dot(a.normal, b.normal);
    if (cosine <= 0) return 0;
    float sharpened = sqr(sqr(cosine));  // cos³²
    sharpened = sqr(sqr(sqr(sharpened)));
    const float off = dot(b.position - a.position, a.normal) / (plane_tolerance * step * a.footprint);
    return sharpened / (1 + sqr(sqr(off)));
}

Spectrum filtered(const FilterImage& image, int x, int y, int step) {
    const auto at = [&](int i, int j) {
        return static_cast<std::size_t>(j) * static_cast<std::size_t>(image.width)
               + static_cast<std::size_t>(i);
    };
    const FilterGuide& middle = image.guides[at(x, y)];
    if (middle.footprint <= 0) return {};
    Spectrum sum;
    float weights = 0;
    for (int dy = -2; dy <= 2; ++dy)
        for (int dx = -2; dx <= 2; ++dx) {
            const int i = x + dx * step, j = y + dy * step;
            if (i < 0 || i >= image.width || j < 0 || j >= image.height) continue;
            const FilterGuide& guide = image.guides[at(i, j)];
            if (guide.footprint <= 0) continue;
            const float weight = spline[static_cast<std::size_t>(std::abs(dx))]
                                 * spline[static_cast<std::size_t>(std::abs(dy))]
                                 * likeness(middle, guide, static_cast<float>(step));
            sum += image.values[at(i, j)] * weight;
            weights += weight;
        }
    return sum / weights;
}

}  // namespace

void filter_along_surfaces(FilterImage& image, int levels, int threads) {
    std::vector<Spectrum> next(image.values.size());
    for (int level = 0; level < levels; ++level) {
        parallel_for(threads, static_cast<std::size_t>(image.height), [&](std::size_t row) {
            for (int x = 0; x < image.width; ++x)
                next[row * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(x)] =
                    filtered(image, x, static_cast<int>(row), 1 << level);
        });
        std::swap(next, image.values);
    }
}

}  // namespace relumine
