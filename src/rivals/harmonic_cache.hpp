// SPDX-License-Identifier: Apache-2.0
// Radiance records: what is seen, as harmonics, for surfaces with broad lobes [Krivanek05].
#pragma once

#include "rivals/irradiance_cache.hpp"
#include "rivals/lobe_harmonics.hpp"
#include "rivals/radiance_harmonics.hpp"

namespace relumine {

/// What a point reflects without the bright part of the light.
struct ReflectedLight {
    Spectrum direct, indirect;
};

class HarmonicCache {
  public:
    HarmonicCache(const RivalSettings& settings, int bands, Masking masking, const IncidentRadiance& source,
                  const BrightSplit& split);

    [[nodiscard]] const Sites& sites() const { return sites_; }

    /// Whether records hold light for this BSDF; the layers that they reflect it by, if so.
    [[nodiscard]] std::optional<MetallicRoughness> holds(const Bsdf& bsdf) const;

    /// See place_sites.
    void place(const PixelRect& frame, const std::function<const SitePoint*(int x, int y)>& point_at,
               float share, SiteRun& run);

    /// The light reflected by `layers` with a diffuse part of this directional albedo: the weighted mean of
    /// the coefficients that all records that may be used expect, times those of the reflection, which are
    /// turned to the world; where there is no record, by what the point sees itself. `found` receives the
    /// records.
    [[nodiscard]] ReflectedLight reflected(const SitePoint& point, Spectrum diffuse,
                                           const MetallicRoughness& layers, LocalDir w_out,
                                           std::vector<FoundSite>& found, RayCounts& rays,
                                           CacheCounts& counts) const;

  private:
    struct Record {
        Vec3 s, t;  // along which its derivatives are
        RadianceHarmonics radiance;
    };
    [[nodiscard]] Record seen_from(const SitePoint& point, RayCounts& rays, Site& site) const;

    PolarGrid grid_;
    LobeHarmonics lobes_;
    const IncidentRadiance& source_;
    const BrightSplit& split_;
    Sites sites_;
    std::vector<Record> records_;  // one per site
};

}  // namespace relumine
