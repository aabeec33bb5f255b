// SPDX-License-Identifier: Apache-2.0
// Means over neighbours.
#include "integrators/light_pilot.hpp"

#include <algorithm>
#include <cmath>

namespace relumine {
namespace {

/// Of what one ray adds to a pixel's mean.
float variance_of_one(const RayNoise& noise, float samples) {
    return noise_of(noise).independent * noise.rays / sqr(samples);
}

}  // namespace

void PilotLight::add(const FoundLight& found, float throughput) {
    samples += 1;
    sum += throughput * luminance(found.radiance + found.mirrored);
    noise.add(together(found.noise, found.mirrored_noise), throughput);
}

void PilotResidual::add(const FoundResidual& found, float expected_of_one, const ShadingPoint& point) {
    const float throughput = luminance(point.path.throughput);
    samples += 1;
    rays += found.bright.rays;
    noise.add(together(found.noise, found.bright.noise), throughput);
    deviation += throughput * expected_of_one;
    if (!seen) seen = point.vertex.point.material;
}

void ResidualScatter::Sums::add(const PilotResidual& pilot, double sign) {
    const double rays = sign * double{pilot.noise.rays};
    found += rays * double{variance_of_one(pilot.noise, pilot.samples)};
    expected += rays * double{sqr(pilot.deviation / pilot.samples)};
}

ResidualScatter::ResidualScatter(std::span<const PilotResidual> cell) {
    for (const PilotResidual& pilot : cell) {
        if (!(pilot.samples > 0)) continue;
        auto sums = std::ranges::find(by_surface_, pilot.seen, &Sums::seen);
        if (sums == by_surface_.end()) sums = by_surface_.insert(sums, Sums{pilot.seen});
        sums->add(pilot, 1);
    }
}

float ResidualScatter::without(const PilotResidual& own) const {
    const auto sums = std::ranges::find(by_surface_, own.seen, &Sums::seen);
    if (sums == by_surface_.end()) return 1;
    Sums others = *sums;
    others.add(own, -1);
    if (!(others.expected > 0)) return 1;
    return static_cast<float>(std::sqrt(std::max(others.found, 0.0) / others.expected));
}

ExpectedLight expected_light(std::span<const PilotLight> cell, int width, int x, int y) {
    constexpr int reach = 2;
    const int height = static_cast<int>(cell.size()) / width;
    float samples = 0, sum = 0, variance = 0;
    for (int j = std::max(y - reach, 0); j <= std::min(y + reach, height - 1); ++j)
        for (int i = std::max(x - reach, 0); i <= std::min(x + reach, width - 1); ++i) {
            if (i == x && j == y) continue;
            const PilotLight& pilot = cell[static_cast<std::size_t>(j * width + i)];
            if (!(pilot.samples > 0)) continue;
            samples += 1;
            sum += pilot.sum / pilot.samples;
            variance += noise_of(pilot.noise).independent / sqr(pilot.samples);
        }
    if (!(samples > 0)) return {};
    return {sum / samples, std::sqrt(variance / samples), true};
}

}  // namespace relumine
