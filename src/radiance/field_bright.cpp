// SPDX-License-Identifier: Apache-2.0
// Radiosities over their mean.
#include "radiance/field_bright.hpp"

#include <array>
#include <cmath>

namespace relumine {
namespace {

constexpr std::array bright_factors{4.0, 16.0, 64.0, 256.0};  // radiosity of bright elements over the mean
constexpr double least_bright_noise = 0.02;                   // of all light, that is worth sampling apart
constexpr float unknown_albedo = 0.5f;                        // of elements that no ray has met

/// Of what rays have met of each element.
std::vector<float> mean_albedos(const FieldCells& cells, const FieldLinks& links) {
    std::vector<float> sums(cells.elements().size()), counts(sums.size());
    for (const Link& l : links.links) {
        sums[l.to] += luminance(l.value());
        counts[l.to] += 1;
    }
    for (std::size_t i = 0; i < sums.size(); ++i)
        sums[i] = counts[i] > 0 ? sums[i] / counts[i] : unknown_albedo;
    return sums;
}

std::vector<float> mean_radiosities(const FieldCells& cells, const FieldLinks& links,
                                    std::span<const Spectrum> irradiance) {
    std::vector<float> radiosity = mean_albedos(cells, links);
    for (std::size_t i = 0; i < radiosity.size(); ++i)
        radiosity[i] = std::max(0.0f, luminance(irradiance[i]) * radiosity[i]);
    return radiosity;
}

/// What stratified rays over all directions miss of a part of all light that comes from such an area,
/// seen from such a distance: their number within it, to the power of −3/4.
double noise_of(double share, double area, double distance) {
    constexpr double rays = 4096;
    const double met = rays * area / (4 * double{pi} * distance * distance);
    return share * std::pow(std::max(met, 1.0), -0.75);
}

}  // namespace

BrightSurfaces find_bright(FieldCells& cells, const FieldLinks& links, std::span<const Spectrum> irradiance,
                           double distance) {
    BrightSurfaces bright;
    const std::vector<float> radiosity = mean_radiosities(cells, links, irradiance);
    double power = 0, area = 0;
    std::vector<FieldElement>& elements = cells.elements();
    for (std::size_t i = 0; i < elements.size(); ++i) {
        power += radiosity[i] * sqr(elements[i].size);
        area += sqr(elements[i].size);
    }
    if (!(power > 0)) return bright;
    bright.mean_radiance = static_cast<float>(power / area) * inv_pi;
    for (const double factor : bright_factors) {
        const auto is_bright = [&](std::size_t i) {
            return !elements[i].coarse && double{radiosity[i]} * area > factor * power;
        };
        double bright_power = 0, bright_area = 0;
        for (std::size_t i = 0; i < elements.size(); ++i) {
            if (!is_bright(i)) continue;
            bright_power += radiosity[i] * sqr(elements[i].size);
            bright_area += sqr(elements[i].size);
        }
        if (noise_of(bright_power / power, bright_area, distance) < least_bright_noise) continue;
        for (std::size_t i = 0; i < elements.size(); ++i) elements[i].bright = is_bright(i);
        bright.cones = BrightCones(cells, radiosity);
        break;
    }
    return bright;
}

}  // namespace relumine
