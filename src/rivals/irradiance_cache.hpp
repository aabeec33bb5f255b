// SPDX-License-Identifier: Apache-2.0
// Irradiance records: made where placement asks, averaged where points ask [Ward88].
#pragma once

#include "rivals/irradiance.hpp"
#include "rivals/site_placement.hpp"

namespace relumine {

struct RivalSettings {
    int rays = 64;          // n: a record has about n² rays
    float accuracy = 0.2f;  // a
};

/// A point's irradiance without the bright part of the light, W·m⁻².
struct PointIrradiance {
    Spectrum direct, indirect;
};

class IrradianceCache {
  public:
    IrradianceCache(const RivalSettings& settings, const IncidentRadiance& source, const BrightSplit& split);

    [[nodiscard]] const Sites& sites() const { return sites_; }

    /// See place_sites.
    void place(const PixelRect& frame, const std::function<const SitePoint*(int x, int y)>& point_at,
               float share, SiteRun& run);

    /// The weighted mean of what all records that may be used expect at the point [Ward88, Ward92]; where
    /// there is none, what the point sees itself. `found` receives the records.
    [[nodiscard]] PointIrradiance at(const SitePoint& point, std::vector<FoundSite>& found, RayCounts& rays,
                                     CacheCounts& counts) const;

  private:
    [[nodiscard]] SplitIrradiance seen_from(const SitePoint& point, RayCounts& rays, Site& site) const;

    PolarGrid grid_;
    const IncidentRadiance& source_;
    const BrightSplit& split_;
    Sites sites_;
    std::vector<SplitIrradiance> records_;  // one per site
};

}  // namespace relumine
