// SPDX-License-Identifier: Apache-2.0
// Planning.
#include "integrators/cache_plan.hpp"

namespace relumine {
CachePlan cache_plan(const RenderSettings& s) {
    constexpr float usual_error = 0.02f, usual_tolerance = 0.2f, usual_residual = 8, usual_light = 16,
                    usual_rays_per_pixel = 12, usual_most_rays = 800;
    constexpr std::size_t usual_reprojected = 32;
    const float finer = usual_error / s.error, pixel_samples = static_cast<float>(s.samples_per_pixel);
    const auto chosen = [&](int wanted, float usual) {
        return wanted >= 0 ? static_cast<float>(wanted) : std::ceil(usual * finer) / pixel_samples;
    };
    CachePlan plan;
    plan.blocks.tolerance = usual_tolerance / finer;
    plan.blocks.rays_per_pixel = usual_rays_per_pixel * std::max(finer, 1.0f);
    plan.rays = {chosen(s.residual_rays, usual_residual), chosen(s.light_samples, usual_light)};
    plan.blocks.most_rays = usual_most_rays * std::max(finer, 1.0f);
    plan.reprojected = usual_reprojected;
    plan.exact = s.unbiased;
    plan.filters = s.filter_residual && !s.unbiased && plan.rays.residual + plan.rays.light > 0;
    if (s.unbiased && plan.rays.residual == 0) plan.rays.residual = 1;
    return plan;
}

CachePlan block_gather_plan(const RenderSettings& s) {
    CachePlan plan = cache_plan(s);
    plan.blocks.largest = plan.blocks.smallest = 8;
    plan.blocks.rays_per_pixel *= 2;  // of its own, since there are no others
    plan.blocks.most_rays = BlockSettings{}.most_rays;
    plan.rays.residual = 0;
    plan.reprojected = 0;
    plan.exact = plan.filters = false;
    return plan;
}

}  // namespace relumine
