// SPDX-License-Identifier: Apache-2.0
// Making and using irradiance records.
#include "rivals/irradiance_cache.hpp"

namespace relumine {

IrradianceCache::IrradianceCache(const RivalSettings& settings, const IncidentRadiance& source,
                                 const BrightSplit& split)
    : grid_(polar_grid(Rings::cosine, settings.rays)),
      source_(source),
      split_(split),
      sites_(settings.accuracy) {}

SplitIrradiance IrradianceCache::seen_from(const SitePoint& point, RayCounts& rays, Site& site) const {
    const PolarHemisphere seen = trace_polar(source_, split_, point, grid_, rays);
    SplitIrradiance e = irradiance_of(seen, point.frame);
    const SiteRadius radius =
        site_radius(seen.harmonic_distance(), change_length(e), point.footprint, sites_.accuracy());
    e.direct.translation = e.direct.translation * radius.gradient_scale;
    e.indirect.translation = e.indirect.translation * radius.gradient_scale;
    site = {point.position, point.frame.n, radius.radius, radius.least};
    return e;
}

void IrradianceCache::place(const PixelRect& frame,
                            const std::function<const SitePoint*(int x, int y)>& point_at, float share,
                            SiteRun& run) {
    const SiteMaker maker{[&](std::size_t count) { records_.resize(count); },
                          [&](std::size_t id, const SitePoint& point, RayCounts& rays, CacheCounts& counts) {
                              Site site;
                              records_[id] = seen_from(point, rays, site);
                              ++counts.records;
                              counts.record_bytes += sizeof(Site) + sizeof(SplitIrradiance);
                              return site;
                          }};
    place_sites(frame, point_at, share, maker, sites_, run);
}

PointIrradiance IrradianceCache::at(const SitePoint& point, std::vector<FoundSite>& found, RayCounts& rays,
                                    CacheCounts& counts) const {
    {
        const StepTimer timer(counts, CacheStep::lookup);
        sites_.find(point.position, point.frame.n, found);
    }
    if (found.empty()) {
        const StepTimer timer(counts, CacheStep::create);
        Site site;
        const SplitIrradiance own = seen_from(point, rays, site);
        ++counts.records;
        return {own.direct.value, own.indirect.value};
    }
    const StepTimer timer(counts, CacheStep::shade);
    PointIrradiance sum;
    float weights = 0;
    for (const FoundSite& f : found) {
        const Site& site = sites_[f.id];
        const Vec3 offset = point.position - site.position;
        const SplitIrradiance& record = records_[f.id];
        sum.direct += f.weight * extrapolated(record.direct, site.normal, offset, point.frame.n);
        sum.indirect += f.weight * extrapolated(record.indirect, site.normal, offset, point.frame.n);
        weights += f.weight;
    }
    return {sum.direct / weights, sum.indirect / weights};
}

}  // namespace relumine
