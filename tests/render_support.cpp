// SPDX-License-Identifier: Apache-2.0
// Rendering small pictures in tests.
#include "tests/render_support.hpp"

#include <algorithm>
#include <numeric>

namespace relumine::testing {

Scene project_scene(const std::string& name, const std::string& environment) {
    const std::string folder = RELUMINE_SOURCE_DIR "/scenes/";
    SceneOptions options;
    if (!environment.empty()) options.environment = folder + environment;
    return load_scene(folder + name, options);
}

double mean_of(const Image& image) {
    const auto& pixels = image.layer()->pixels;
    return std::accumulate(pixels.begin(), pixels.end(), 0.0) / static_cast<double>(pixels.size());
}

std::vector<double> block_means(const Image& image, int side) {
    const int columns = image.width / side, rows = image.height / side;
    std::vector<double> means(static_cast<std::size_t>(columns * rows));
    for (int y = 0; y < rows * side; ++y)
        for (int x = 0; x < columns * side; ++x) {
            const auto [r, g, b] = image.rgb(x, y);
            means[static_cast<std::size_t>(y / side * columns + x / side)] +=
                (double{r} + g + b) / (3 * side * side);
        }
    return means;
}

std::vector<Estimate> block_estimates(const Scene& scene, RenderSettings settings, int seeds, int side) {
    std::vector<std::vector<double>> by_block;
    for (int seed = 1; seed <= seeds; ++seed) {
        settings.seed = static_cast<std::uint64_t>(seed);
        const std::vector<double> means = block_means(render(scene, settings), side);
        by_block.resize(means.size());
        for (std::size_t i = 0; i < means.size(); ++i) by_block[i].push_back(means[i]);
    }
    std::vector<Estimate> estimates;
    for (const auto& values : by_block) estimates.push_back(estimate(values));
    return estimates;
}

double agreement_p(const std::vector<Estimate>& a, const std::vector<Estimate>& b, double scale) {
    double least = 1;
    for (std::size_t i = 0; i < a.size(); ++i)
        least = std::min(least, welch_p(a[i], {scale * b[i].mean, scale * b[i].standard_error, b[i].count}));
    return 1 - std::pow(1 - least, static_cast<double>(a.size()));
}

}  // namespace relumine::testing
