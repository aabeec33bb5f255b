// SPDX-License-Identifier: Apache-2.0
// `reproject-mc` is unbiased: its mean over many seeds is that of `gather`, to 0.1 %, and its error falls as
// 1/√seeds.
#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "tests/render_support.hpp"

namespace relumine {
namespace {

using testing::agreement_p;
using testing::block_means;
using testing::Estimate;
using testing::estimate;
using testing::project_scene;
using testing::sidak;
using testing::welch_p;

constexpr double false_positive_rate = 1e-5;  // of each check below, for each scene; seeds are fixed
constexpr int side = 12, block_side = 4;      // pixels
constexpr std::size_t seeds = 256;
constexpr int reference_rays = 4096;
const float default_bsdf_share = RenderSettings{}.bsdf_share;

struct Case {
    const char *name, *scene, *environment, *radiance;
    int max_depth, gather_rays;
};
const std::array cases{
    Case{"Cornell", "cornell-glossy.glb", "", "path", 4, 256},
    Case{"Open", "validation/open.glb", "validation/sky.pfm", "emission", -1, 64},
    Case{"Shadow", "shadow.glb", "validation/sky.pfm", "emission", -1, 64},
};

RenderSettings settings_for(const Case& c, const std::string& method, int gather_rays) {
    RenderSettings settings;
    settings.method = method;
    settings.width = settings.height = side;
    settings.samples_per_pixel = 1;
    settings.pixel_sampling = "center";  // no noise from edges in view
    settings.radiance = c.radiance;
    settings.max_depth = c.max_depth;
    settings.gather_rays = gather_rays;
    settings.record_size = 16;
    settings.gap_cell = 8;
    settings.threads = 1;  // seeds go in parallel instead
    return settings;
}

/// One picture for each seed from 1 on, as block means.
using Pictures = std::vector<std::vector<double>>;

Pictures render_seeds(const Scene& scene, RenderSettings settings, std::size_t count) {
    Pictures pictures(count);
    std::atomic<std::size_t> next{0};
    const auto work = [&] {
        RenderSettings mine = settings;
        for (std::size_t i = next++; i < count; i = next++) {
            mine.seed = i + 1;
            pictures[i] = block_means(render(scene, mine), block_side);
        }
    };
    std::vector<std::jthread> threads(std::max(1u, std::thread::hardware_concurrency()));
    for (std::jthread& thread : threads) thread = std::jthread(work);
    threads.clear();  // joins
    return pictures;
}

std::vector<Estimate> blocks(const Pictures& pictures) {
    std::vector<Estimate> estimates;
    for (std::size_t block = 0; block < pictures.front().size(); ++block) {
        std::vector<double> values;
        for (const auto& picture : pictures) values.push_back(picture[block]);
        estimates.push_back(estimate(values));
    }
    return estimates;
}

/// The mean of the whole picture, seed by seed.
std::vector<double> picture_means(const Pictures& pictures) {
    std::vector<double> means;
    for (const auto& picture : pictures) {
        double sum = 0;
        for (const double block : picture) sum += block;
        means.push_back(sum / static_cast<double>(picture.size()));
    }
    return means;
}

class ReprojectMc : public ::testing::TestWithParam<std::size_t> {
  protected:
    [[nodiscard]] Pictures cached(float bsdf_share, std::size_t count) const {
        RenderSettings settings = settings_for(scene_case, "reproject-mc", scene_case.gather_rays);
        settings.bsdf_share = bsdf_share;
        return render_seeds(scene, settings, count);
    }
    const Case& scene_case = cases[GetParam()];
    const Scene scene = project_scene(scene_case.scene, scene_case.environment);
    const Pictures gathered = render_seeds(scene, settings_for(scene_case, "gather", reference_rays), 12);
    const Estimate reference = estimate(picture_means(gathered));
};
INSTANTIATE_TEST_SUITE_P(Scenes, ReprojectMc, ::testing::Range(std::size_t{0}, cases.size()),
                         [](const auto& c) { return cases[c.param].name; });

/// Means of groups of `size` seeds, each against the reference.
std::vector<double> group_errors(const std::vector<double>& means, std::size_t size, double reference) {
    std::vector<double> errors;
    for (std::size_t first = 0; first + size <= means.size(); first += size)
        errors.push_back(estimate(std::span(means).subspan(first, size)).mean - reference);
    return errors;
}

double root_mean_square(const std::vector<double>& values) {
    double sum = 0;
    for (const double value : values) sum += value * value;
    return std::sqrt(sum / static_cast<double>(values.size()));
}

/// The p-value of errors of means of `size` seeds being as small as their scatter predicts:
/// n·(rms/predicted)² is χ² with n degrees.
double p_of_errors(const std::vector<double>& means, std::size_t size, const Estimate& reference) {
    const double deviation = estimate(means).standard_error * std::sqrt(static_cast<double>(means.size()));
    const double predicted =
        std::hypot(deviation / std::sqrt(static_cast<double>(size)), reference.standard_error);
    const std::vector<double> errors = group_errors(means, size, reference.mean);
    const auto n = static_cast<double>(errors.size());
    const double ratio = root_mean_square(errors) / predicted;
    return testing::chi_square_tail(n * ratio * ratio, n);
}

void expect_error_falls(const std::vector<double>& means, const Estimate& reference) {
    const double level = sidak(false_positive_rate, 4);
    for (const std::size_t size : {4u, 16u, 64u, 256u})
        EXPECT_GT(p_of_errors(means, size, reference), level) << size;
    const Estimate all = estimate(means);
    EXPECT_LT(all.standard_error, 0.001 * reference.mean);
    EXPECT_LT(std::abs(all.mean - reference.mean),
              4.5 * std::hypot(all.standard_error, reference.standard_error));
    EXPECT_LT(reference.standard_error, 0.0007 * reference.mean);

    std::vector<double> biased = means;  // the mutant must be caught: its error stops falling at 1 %
    for (double& mean : biased) mean *= 1.01;
    EXPECT_LT(p_of_errors(biased, 256, reference), level);
}

void expect_planted_bias_is_caught(const Estimate& cached, const Estimate& reference) {
    for (const double scale : {0.99, 1.01}) {
        const Estimate biased{scale * cached.mean, scale * cached.standard_error, cached.count};
        EXPECT_LT(welch_p(biased, reference), false_positive_rate) << scale;
    }
}

/// Block means: Welch, 9 blocks, Šidák. The picture's mean: χ² at 4, 16, 64, 256 seeds, Šidák, down to 0.1 %.
/// One test, because the pictures are most of its time.
TEST_P(ReprojectMc, IsUnbiasedAndItsErrorFallsAsOneOverTheRootOfTheSeeds) {
    const Pictures pictures = cached(default_bsdf_share, seeds);
    const std::vector<double> means = picture_means(pictures);
    EXPECT_GT(agreement_p(blocks(pictures), blocks(gathered)), false_positive_rate);
    expect_error_falls(means, reference);
    expect_planted_bias_is_caught(estimate(means), reference);
}

/// Without rays from the BSDF, directions that records show black are never looked at: the paper's own
/// estimator loses light, 1.4 to 1.8 % of it on these scenes with records of 16 × 16 rays.
TEST_P(ReprojectMc, WithoutBsdfRaysItLosesLight) {  // Welch
    const Estimate paper = estimate(picture_means(cached(0, 48)));
    EXPECT_LT(paper.mean, 0.995 * reference.mean);
    EXPECT_LT(welch_p(paper, reference), false_positive_rate);
}

}  // namespace
}  // namespace relumine
