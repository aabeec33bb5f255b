// SPDX-License-Identifier: Apache-2.0
// What a point sees, in rings and sectors around its normal: the strata that the gradients of Ward and
// Heckbert are made of [Ward92].
#pragma once

#include <vector>

#include "blocks/bright_split.hpp"
#include "radiance/incident.hpp"

namespace relumine {

/// Where a record may be made.
struct SitePoint {
    Vec3 position;
    Frame frame;              // around the shading normal, on the viewer's side
    Vec3 geometric_normal;    // likewise
    float offset = 0;         // metres along the geometric normal that clear rounding errors
    std::uint32_t depth = 0;  // scattering vertices before the point
    float footprint = 0;      // metres that a pixel covers there
    std::uint64_t key = 0;    // of the record's random numbers
};

/// How rings are cut: all of one weight under the cosine, or of one solid angle.
enum class Rings : std::uint8_t { cosine, even };

/// The strata: `rings` × `sectors`, each of one share of the measure.
struct PolarGrid {
    Rings kind = Rings::cosine;
    int rings = 0, sectors = 0;

    [[nodiscard]] std::size_t size() const {
        return static_cast<std::size_t>(rings) * static_cast<std::size_t>(sectors);
    }
    [[nodiscard]] std::size_t index(int ring, int sector) const {
        return static_cast<std::size_t>(ring) * static_cast<std::size_t>(sectors)
               + static_cast<std::size_t>(sector);
    }
    /// cos θ where `ring` begins, seen from the pole; fractions lie inside rings.
    [[nodiscard]] float cosine(float ring) const {
        const float share = ring / static_cast<float>(rings);
        return kind == Rings::cosine ? std::sqrt(std::max(0.0f, 1 - share)) : 1 - share;
    }
    /// φ where `sector` begins, radians.
    [[nodiscard]] float azimuth(float sector) const { return 2 * pi * sector / static_cast<float>(sectors); }
    [[nodiscard]] LocalDir direction(float ring, float sector) const;
};

/// About rays² strata that are about as high as wide: π rings' worth of sectors [Ward92].
[[nodiscard]] PolarGrid polar_grid(Rings kind, int rays);

/// What the ray through one stratum has found.
struct PolarSample {
    Spectrum direct, indirect;  // incident, without the bright part of the light
    LocalDir direction{};       // in the site's frame
    float distance = infinity;  // metres
    bool open = true;           // false: below the surface, where nothing comes from
};

/// Samples of all strata, ring by ring from the pole.
struct PolarHemisphere {
    PolarGrid grid;
    std::vector<PolarSample> samples;

    [[nodiscard]] const PolarSample& at(int ring, int sector) const {
        return samples[grid.index(ring, sector)];
    }
    /// The harmonic mean of the distances, metres; infinite where nothing is hit [Ward88].
    [[nodiscard]] float harmonic_distance() const;
};

/// One ray through each stratum, jittered by a hash of the site's key. Adds rays of RayPurpose::record.
[[nodiscard]] PolarHemisphere trace_polar(const IncidentRadiance& source, const BrightSplit& split,
                                          const SitePoint& site, const PolarGrid& grid, RayCounts& counts);

/// What is left of `found` along a traced ray when the bright part of the light is taken away.
struct DimPart {
    Spectrum direct;           // dim
    BrightSplit::Part bright;  // of what came straight from a light
};
[[nodiscard]] DimPart split_direct(const Transport& t, const BrightSplit& split, const Ray& ray,
                                   const Hit& hit, Spectrum direct);

}  // namespace relumine
