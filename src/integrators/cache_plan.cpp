// SPDX-License-Identifier: Apache-2.0
// Planning.
#include "integrators/cache_plan.hpp"

namespace relumine {
namespace {

/// Light samples that are well spread: variance falls with this power of their number.
constexpr float light_power = 1.3f;

/// RayDemand::residual_gain of rays that stand for themselves: their deviation is on the safe side.
constexpr float gain_without_filter = 1.2f;

constexpr float most_rays = 4096;  // of a kind, per pixel

/// The integral does not resolve lobes that are sharper: 2 α radians are less than three of its points.
constexpr float unresolved_alpha = 0.02f;

/// The nearest power of two; 0 below ½ of `least`.
float power_of_two(float rays, float least) {
    if (!(rays >= least / 2)) return 0;
    return std::exp2(std::round(std::log2(std::clamp(rays, least, most_rays))));
}

RayDemand ray_demand(const RenderSettings& s) {
    constexpr float l1_of_sigma = 0.8f;  // of normal errors
    RayDemand demand;
    demand.residual_adapts = s.residual_rays < 0;
    demand.light_adapts = s.light_samples < 0;
    demand.sigma = s.error / l1_of_sigma;
    const bool filters = s.filter_residual && !s.unbiased;
    demand.residual_gain = filters ? 2.6f : gain_without_filter;
    demand.light_gain = filters ? 1.0f : 0.5f;
    demand.least_residual = std::max(1.0f, power_of_two(0.32f / s.error, 1));
    demand.pilot = std::clamp(power_of_two(0.08f / s.error, 1), 2.0f, 16.0f);
    return demand;
}

void leave_out(const std::vector<std::string>& parts, CachePlan& plan) {
    const auto named = [&](const char* part) { return std::ranges::find(parts, part) != parts.end(); };
    if (named("reprojection")) plan.reprojected = 0;
    if (named("splits")) plan.blocks.smallest = plan.blocks.largest;
    if (named("blending")) plan.blends = false;
    if (named("sharp-lobes")) plan.sharp_alpha = 0;
}

}  // namespace

float RayDemand::residual_rays(float doubt) const {
    return std::max(least_residual, power_of_two(sqr(deviation_of_one * doubt / (sigma * residual_gain)), 1));
}

float RayDemand::more_residual(float scatter, float before) {
    constexpr float tolerated = 1.5f, most = 8;
    return power_of_two((std::min(scatter / tolerated, most) - 1) * before, before);
}

float RayDemand::more_light(float noise) const {
    const float wanted = pilot * std::pow(noise / (sigma * light_gain), 2 / light_power);
    return power_of_two(wanted - pilot, pilot);
}

CachePlan cache_plan(const RenderSettings& s) {
    constexpr float usual_error = 0.02f, usual_tolerance = 0.8f, usual_residual = 8, usual_light = 16,
                    usual_rays_per_pixel = 12, usual_most_rays = 800, usual_lobe_rays = 16;
    constexpr std::size_t usual_reprojected = 32;
    const float finer = usual_error / s.error, pixel_samples = static_cast<float>(s.samples_per_pixel);
    const auto chosen = [&](int wanted, float usual) {
        return wanted >= 0 ? static_cast<float>(wanted) : std::ceil(usual * finer) / pixel_samples;
    };
    CachePlan plan;
    plan.blocks.tolerance = usual_tolerance / finer;
    plan.blocks.rays_per_pixel = usual_rays_per_pixel * std::max(finer, 1.0f);
    plan.rays = {chosen(s.residual_rays, usual_residual), chosen(s.light_samples, usual_light)};
    plan.demand = ray_demand(s);
    plan.pixel_samples = pixel_samples;
    plan.lobe_rays = std::max(1.0f, std::ceil(usual_lobe_rays * finer) / pixel_samples);
    plan.blocks.most_rays = usual_most_rays * std::max(finer, 1.0f);
    plan.reprojected = usual_reprojected;
    plan.exact = s.unbiased;
    plan.filters = s.filter_residual && !s.unbiased && plan.rays.residual + plan.rays.light > 0;
    if (s.unbiased && plan.rays.residual == 0) plan.rays.residual = 1;
    if (plan.rays.residual > 0) plan.sharp_alpha = unresolved_alpha;
    leave_out(s.without, plan);
    return plan;
}

RenderSettings monte_carlo_settings(const RenderSettings& s) {
    RayDemand demand = ray_demand(s);
    demand.residual_gain = gain_without_filter;
    const float rays = std::ceil(demand.residual_rays(1) / static_cast<float>(s.samples_per_pixel));
    RenderSettings mine = s;
    mine.gather_rays = static_cast<int>(rays);
    if (s.light_samples < 0) mine.light_samples = static_cast<int>(std::ceil(rays / 4));
    return mine;
}

CachePlan block_gather_plan(const RenderSettings& s) {
    CachePlan plan = cache_plan(s);
    plan.blocks.largest = plan.blocks.smallest = 8;
    plan.blocks.rays_per_pixel *= 2;  // of its own, since there are no others
    plan.blocks.most_rays = BlockSettings{}.most_rays;
    plan.rays.residual = plan.sharp_alpha = 0;
    plan.demand.residual_adapts = plan.demand.light_adapts = false;
    plan.reprojected = 0;
    plan.exact = plan.filters = false;
    return plan;
}

}  // namespace relumine
