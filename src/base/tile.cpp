// SPDX-License-Identifier: Apache-2.0
// Summing camera samples.
#include "base/tile.hpp"

#include <cmath>
#include <limits>

namespace relumine {

Tile make_tile(const PixelRect& rect, std::uint32_t first_sample, std::uint32_t sample_count) {
    Tile tile{rect, first_sample, sample_count, {}, {}, {}, 0, {}};
    tile.pixels.resize(static_cast<std::size_t>(rect.width()) * static_cast<std::size_t>(rect.height()));
    return tile;
}

bool can_be_summed(const Spectrum& radiance) {
    constexpr float most_samples = 0x1p20f, largest = std::numeric_limits<float>::max() / (2 * most_samples);
    const auto small = [](float x) { return std::abs(x) <= largest; };  // NaN is not
    return small(radiance.r) && small(radiance.g) && small(radiance.b);
}

void Tile::add(int x, int y, std::uint32_t sample, const SplitRadiance& radiance, const FirstSurface& surface,
               const CacheFigures& figures) {
    if (probe && probe->wanted == SampleId{x, y, sample}) probe->seen = radiance;
    const Spectrum total = radiance.total();
    if (!can_be_summed(total)) {
        if (!first_non_finite) first_non_finite = SampleId{x, y, sample};
        ++non_finite;
        return;
    }
    PixelSums& pixel = pixels[static_cast<std::size_t>(y - rect.y0) * static_cast<std::size_t>(rect.width())
                              + static_cast<std::size_t>(x - rect.x0)];
    pixel.radiance += total;
    pixel.radiance_squared += total * total;
    pixel.split.emission += radiance.emission;
    pixel.split.direct += radiance.direct;
    pixel.split.indirect += radiance.indirect;
    pixel.albedo += surface.albedo;
    pixel.normal += surface.normal;
    pixel.cache.records += figures.records;
    pixel.cache.gaps += figures.gaps;
    pixel.cache.layers += figures.layers;
    pixel.cache.unknown += figures.unknown;
    if (sample == 0) pixel.first = surface;
    ++pixel.samples;
}

}  // namespace relumine
