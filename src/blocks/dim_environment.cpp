// SPDX-License-Identifier: Apache-2.0
// Averaging the environment.
#include "blocks/dim_environment.hpp"

#include "base/executor.hpp"

namespace relumine {
namespace {

constexpr int least_samples = 4, most_samples = 16;  // per texel of the finest grid, along each side

/// So many that no texel of the environment is missed, within reason.
int samples_along_side(const Environment& e, const DirectionGrid& grid) {
    return std::clamp(e.height / grid.side, least_samples, most_samples);
}

std::vector<Spectrum> texel_means(const Transport& t, const BrightSplit& split, const DirectionGrid& grid,
                                  int threads) {
    std::vector<Spectrum> means(grid.texels);
    if (!t.scene.environment) return means;
    const int samples = samples_along_side(*t.scene.environment, grid);
    const auto along = [&](int k) { return (static_cast<float>(k) + 0.5f) / static_cast<float>(samples); };
    parallel_for(threads, grid.tiles, [&](std::size_t tile) {
        for (std::size_t texel = tile * tile_texels; texel < (tile + 1) * tile_texels; ++texel) {
            Spectrum sum;
            for (int i = 0; i < samples * samples; ++i) {
                const WorldDir d = grid.direction_in(static_cast<std::uint32_t>(texel),
                                                     {along(i % samples), along(i / samples)});
                const Spectrum radiance = t.lights.environment_radiance(d);
                sum += radiance * (1 - split.of_environment(d, radiance).share);
            }
            means[texel] = sum / static_cast<float>(samples * samples);
        }
    });
    return means;
}

/// The same on a grid with half the texels along each side: Morton order keeps four children together.
std::vector<Spectrum> coarser(const std::vector<Spectrum>& finer) {
    std::vector<Spectrum> means;
    for (std::size_t i = 0; i < finer.size(); i += 4)
        means.push_back(0.25f * ((finer[i] + finer[i + 1]) + (finer[i + 2] + finer[i + 3])));
    return means;
}

RadianceRuns as_runs(const std::vector<Spectrum>& means, std::size_t per_texel) {
    RadianceRuns runs;
    for (auto* plane : {&runs.r, &runs.g, &runs.b}) plane->resize(means.size());
    for (std::size_t point = 0; point < means.size(); ++point) {
        const std::size_t to = run_position(point, per_texel);
        runs.r[to] = means[point].r;
        runs.g[to] = means[point].g;
        runs.b[to] = means[point].b;
    }
    return runs;
}

}  // namespace

DimEnvironment::DimEnvironment(const Transport& t, const BrightSplit& split, const DirectionGrid& grid,
                               int threads) {
    const DirectionGrid finest(grid.side << (fine_tiers.size() - 1));
    std::vector<Spectrum> means = texel_means(t, split, finest, threads);
    for (std::size_t tier = fine_tiers.size(); tier-- > 0;) {
        points[tier] = as_runs(means, points_per_texel(tier));
        if (tier > 0) means = coarser(means);
    }
    texels = std::move(means);
    for (const Spectrum& radiance : texels)
        luminance += relumine::luminance(radiance) / static_cast<float>(texels.size());
}

}  // namespace relumine
