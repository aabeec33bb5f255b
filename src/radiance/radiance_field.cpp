// SPDX-License-Identifier: Apache-2.0
// Asking a radiance field.
#include "radiance/radiance_field.hpp"

#include "radiance/field_builder.hpp"

namespace relumine {

RadianceField::RadianceField(const Transport& t, std::span<const FieldSeed> seeds,
                             const FieldSettings& settings, RayCounts& rays)
    : RadianceField(t, build_field(t, seeds, settings, rays), settings.threads, rays) {}

RadianceField::RadianceField(const Transport& t, BuiltField built, int threads, RayCounts& rays)
    : figures_(built.figures),
      cones_(std::move(built.bright.cones)),
      arrivals_(std::move(built.arrivals)),
      mean_radiance_(built.bright.mean_radiance),
      most_found_(built.most_found),
      cells_(std::move(built.cells)),
      neighbors_(t, cells_, threads, rays) {
    for (std::size_t i = 1; i <= built.reflections.limit && built.reflections.share_without(1) < 1; ++i) {
        shares_.push_back(built.reflections.share_without(i));
        if (shares_.back() == 0) break;
    }
    neighbors_.smooth(built.noisy, threads, cells_);
    figures_.bytes = cells_.bytes() + neighbors_.bytes() + arrivals_.size() * sizeof(ElementArrivals);
}

PlacedArrivals RadianceField::arrivals(Vec3 position, Vec3 geometric_normal) const {
    if (arrivals_.empty()) return {};
    const ElementId home = cells_.find(position, geometric_normal);
    if (home == no_element) return {};
    const ElementArrivals& a = arrivals_[home];
    return {&a.surfaces, &a.sky, a.sky_share, frame_around(cells_.elements()[home].normal)};
}

bool RadianceField::is_bright(Vec3 position, Vec3 geometric_normal) const {
    if (cones_.empty()) return false;
    const ElementId home = cells_.find(position, geometric_normal);
    return home != no_element && cells_.elements()[home].bright;
}

std::optional<Spectrum> RadianceField::irradiance(Vec3 position, Vec3 geometric_normal,
                                                  Vec3 shading_normal) const {
    const ElementId home = cells_.find(position, geometric_normal);
    if (home == no_element) return {};
    return neighbors_.irradiance(cells_, home, position, shading_normal);
}

}  // namespace relumine
