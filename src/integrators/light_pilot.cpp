// SPDX-License-Identifier: Apache-2.0
// Means over neighbours.
#include "integrators/light_pilot.hpp"

#include <cmath>

namespace relumine {

void PilotLight::add(const FoundLight& found, float throughput) {
    samples += 1;
    sum += throughput * luminance(found.radiance + found.mirrored);
    noise.add(together(found.noise, found.mirrored_noise), throughput);
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
