// SPDX-License-Identifier: Apache-2.0
// What integrators hand to the film: a tile of pixels with sums over camera samples.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "base/cache_counts.hpp"
#include "base/ray_counts.hpp"
#include "base/vec.hpp"
#include "relumine/image.hpp"

namespace relumine {

/// Radiance towards the camera by the number of scattering vertices behind the specular prefix: none, one,
/// more.
struct SplitRadiance {
    Spectrum emission, direct, indirect;

    [[nodiscard]] Spectrum total() const { return emission + direct + indirect; }
};

/// What is seen first through a camera sample; all zero where nothing is hit.
struct FirstSurface {
    Spectrum albedo;
    Vec3 normal;            // shading normal, world space, on the viewer's side
    Vec3 position;          // world space
    float depth = 0;        // metres along the camera ray
    float material_id = 0;  // index + 1; 0: nothing
};

/// How records served a camera sample; all zero where none did.
struct CacheFigures {
    float records = 0;  // reprojected
    float gaps = 0;     // share of the hemisphere left open after that, [0, 1]
    float layers = 0;   // of these records that were seen
    float unknown = 0;  // share of the hemisphere in the last record's unknown mask, [0, 1]
};

/// What a method says of its own error; 0 where it says nothing. Of the sum over a pixel's samples,
/// luminance.
struct PredictedError {
    float variance = 0;   // of what is drawn at random, independent from pass to pass
    float deviation = 0;  // one sigma of what all passes have in common
};

/// Sums over the samples of one pixel.
struct PixelSums {
    Spectrum radiance, radiance_squared;
    SplitRadiance split;
    Spectrum albedo;
    Vec3 normal;
    CacheFigures cache;
    PredictedError error;
    FirstSurface first;  // of sample 0 alone: positions and ids have no mean
    std::uint32_t samples = 0;
};

/// Which camera sample: of which pixel, and which of its samples.
struct SampleId {
    int x = 0, y = 0;  // full frame
    std::uint32_t sample = 0;
    bool operator==(const SampleId&) const = default;
};

/// Whether a sample is finite, and far enough from the largest float that sums over a pixel's samples are,
/// too.
[[nodiscard]] bool can_be_summed(const Spectrum& radiance);

/// Waits for one camera sample and keeps what it has brought.
struct SampleProbe {
    SampleId wanted;
    std::optional<SplitRadiance> seen;
};

/// Sums for the samples [first_sample, first_sample + sample_count) of all pixels of `rect`.
struct Tile {
    PixelRect rect;  // full-frame pixels, clipped to the crop
    std::uint32_t first_sample = 0, sample_count = 0;
    std::vector<PixelSums> pixels;  // row-major over rect
    RayCounts rays;
    CacheCounts cache;
    std::uint64_t non_finite = 0;  // samples dropped
    std::optional<SampleId> first_non_finite;
    SampleProbe* probe = nullptr;  // may be null

    [[nodiscard]] bool contains(int x, int y) const {
        return x >= rect.x0 && x < rect.x1 && y >= rect.y0 && y < rect.y1;
    }

    /// Adds a sample to its pixel, which the tile contains, or drops it where the radiance cannot be summed.
    void add(int x, int y, std::uint32_t sample, const SplitRadiance& radiance, const FirstSurface& surface,
             const CacheFigures& figures = {});
};

/// An empty tile over `rect`.
[[nodiscard]] Tile make_tile(const PixelRect& rect, std::uint32_t first_sample, std::uint32_t sample_count);

}  // namespace relumine
