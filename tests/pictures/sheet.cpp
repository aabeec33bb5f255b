// SPDX-License-Identifier: Apache-2.0
// Pictures side by side, for people to look at.
#include "tests/pictures/sheet.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "relumine/compare.hpp"

namespace relumine::pictures {
namespace {

constexpr int gap = 2;  // pixels between pictures; twice that between triples

Image blank(int width, int height) {
    Image image;
    image.width = image.frame_width = width;
    image.height = image.frame_height = height;
    image.window = {0, 0, width, height};
    const auto values = 3 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    image.layers = {{"", {"R", "G", "B"}, std::vector<float>(values, 1.0f)}};
    return image;
}

void paste(const Image& picture, float factor, int magnification, int x0, int y0, Image& sheet) {
    std::vector<float>& pixels = sheet.layers.front().pixels;
    for (int y = 0; y < picture.height * magnification; ++y)
        for (int x = 0; x < picture.width * magnification; ++x) {
            const auto colour = picture.rgb(x / magnification, y / magnification);
            const auto at = 3 * static_cast<std::size_t>((y0 + y) * sheet.width + x0 + x);
            for (std::size_t c = 0; c < 3; ++c) pixels[at + c] = factor * colour[c];
        }
}

double mean_of(const Image& image) {
    const std::vector<float>& pixels = image.layer()->pixels;
    double sum = 0;
    for (const float value : pixels) sum += static_cast<double>(std::abs(value));
    return std::max(1e-6, sum / static_cast<double>(pixels.size()));
}

}  // namespace

Image sheet_of(const std::vector<Triple>& triples, int columns, int magnification) {
    int width = 1, height = 1;  // of the largest picture, magnified
    for (const Triple& t : triples) {
        width = std::max(width, t.before.width * magnification);
        height = std::max(height, t.before.height * magnification);
    }
    const int count = static_cast<int>(triples.size());
    const int cell_width = 3 * (width + gap) + gap, cell_height = height + 2 * gap;
    Image sheet = blank(std::min(columns, count) * cell_width, (count + columns - 1) / columns * cell_height);
    for (int i = 0; i < count; ++i) {
        const Triple& t = triples[static_cast<std::size_t>(i)];
        const int x = i % columns * cell_width, y = i / columns * cell_height;
        const double mean = mean_of(t.before);
        const auto exposed = static_cast<float>(0.3 / mean);
        paste(t.before, exposed, magnification, x, y, sheet);
        paste(t.after, exposed, magnification, x + width + gap, y, sheet);
        paste(signed_difference(t.after, t.before, 0.2 * mean), 1, magnification, x + 2 * (width + gap), y,
              sheet);
    }
    return sheet;
}

}  // namespace relumine::pictures
