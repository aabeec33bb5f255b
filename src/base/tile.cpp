// SPDX-License-Identifier: Apache-2.0
// Summing camera samples.
#include "base/tile.hpp"

namespace relumine {

Tile make_tile(const PixelRect& rect, std::uint32_t first_sample, std::uint32_t sample_count) {
    Tile tile{rect, first_sample, sample_count, {}, {}, {}, 0, {}};
    tile.pixels.resize(static_cast<std::size_t>(rect.width()) * static_cast<std::size_t>(rect.height()));
    return tile;
}

void Tile::add(int x, int y, std::uint32_t sample, const SplitRadiance& radiance, const FirstSurface& surface,
               const CacheFigures& figures) {
    const Spectrum total = radiance.total();
    if (!is_finite(total)) {
        if (!first_non_finite) first_non_finite = NonFiniteSample{x, y, sample};
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
