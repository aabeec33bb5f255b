// SPDX-License-Identifier: Apache-2.0
// Scenes, settings and means over seeds for tests of `cache`.
#pragma once

#include <array>
#include <atomic>
#include <string>
#include <thread>
#include <vector>

#include "tests/render_support.hpp"

namespace relumine {

inline constexpr double false_positive_rate = 1e-5;  // of each check below, for each scene; seeds are fixed
inline constexpr int side = 12, block_side = 4;      // pixels

/// One picture for each seed from 1 on, as block means.
using Pictures = std::vector<std::vector<double>>;

inline Pictures render_seeds(const Scene& scene, RenderSettings settings, std::size_t count) {
    settings.threads = 1;  // seeds go in parallel instead
    Pictures pictures(count);
    std::atomic<std::size_t> next{0};
    const auto work = [&] {
        RenderSettings mine = settings;
        for (std::size_t i = next++; i < count; i = next++) {
            mine.seed = i + 1;
            pictures[i] = testing::block_means(render(scene, mine), block_side);
        }
    };
    std::vector<std::jthread> threads(std::max(1u, std::thread::hardware_concurrency()));
    for (std::jthread& thread : threads) thread = std::jthread(work);
    threads.clear();  // joins
    return pictures;
}

inline std::vector<testing::Estimate> blocks(const Pictures& pictures) {
    std::vector<testing::Estimate> estimates;
    for (std::size_t block = 0; block < pictures.front().size(); ++block) {
        std::vector<double> values;
        for (const auto& picture : pictures)
            values.push_back(
                static_cast<float>(picture[block]));  // without the last digits of what is seen directly
        estimates.push_back(testing::estimate(values));
    }
    return estimates;
}

/// Of the whole picture.
inline testing::Estimate whole(const Pictures& pictures) {
    std::vector<double> means;
    for (const auto& picture : pictures) {
        double sum = 0;
        for (const double block : picture) sum += block;
        means.push_back(sum / static_cast<double>(picture.size()));
    }
    return testing::estimate(means);
}

struct Case {
    const char *name, *scene, *environment, *radiance;
    int max_depth;
};
inline const std::array cases{
    Case{"Cornell", "cornell-glossy.glb", "", "path", 4},                       // a lamp, a glossy floor
    Case{"Sunny", "shadow.glb", "sky.exr", "emission", -1},                     // a small sun, sharp metal
    Case{"Open", "validation/open.glb", "validation/sky.pfm", "emission", -1},  // nothing bright
};

inline RenderSettings settings_for(const Case& c, const std::string& method) {
    RenderSettings settings;
    settings.method = method;
    settings.width = settings.height = side;
    settings.samples_per_pixel = 1;
    settings.pixel_sampling = "center";  // no noise from edges in view
    settings.radiance = c.radiance;
    settings.max_depth = c.max_depth;
    settings.gather_rays = 1024;
    return settings;
}

inline RenderSettings unbiased(const Case& c) {
    RenderSettings settings = settings_for(c, "cache");
    settings.unbiased = true;
    if (settings.radiance == std::string("path")) settings.radiance = "auto";  // maps from a radiance field
    settings.samples_per_pixel = 4;  // for each seed makes a radiance field of its own
    settings.residual_rays = 64;
    settings.light_samples = 32;
    return settings;
}

inline RenderSettings gathered(const Case& c) {
    RenderSettings settings = settings_for(c, "gather");
    settings.light_samples = 256;
    return settings;
}

}  // namespace relumine
