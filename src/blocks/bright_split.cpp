// SPDX-License-Identifier: Apache-2.0
// Splitting light.
#include "blocks/bright_split.hpp"

#include "radiance/radiance_field.hpp"

namespace relumine {
namespace {

/// Emitters are bright where they exceed what surfaces reflect so many times.
constexpr float local_factor = 4;

}  // namespace

BrightSplit::BrightSplit(const SceneData& scene, float factor, const RadianceField* field)
    : scene_(scene),
      field_(field),
      threshold_(bright_threshold(scene, factor)),
      lights_(scene, {.threshold = threshold_,
                      .delta_lights = false,
                      .compensate_for_mis = false,
                      .most_local_threshold = field ? local_factor * field->mean_radiance() : infinity}) {}

/// What rises over the threshold, so that the dim part stays continuous at the rim of a sun.
float BrightSplit::excess(Spectrum radiance) const {
    const float mean = (radiance.r + radiance.g + radiance.b) / 3;
    return mean > threshold_ ? 1 - threshold_ / mean : 0;
}

BrightSplit::Part BrightSplit::of_environment(WorldDir direction, Spectrum radiance) const {
    const float share = excess(radiance);
    if (share <= 0) return {};
    const float pdf = lights_.environment_pdf(direction);
    return pdf > 0 ? Part{share, pdf} : Part{};
}

BrightSplit::Part BrightSplit::of_emission(const Ray& ray, const Hit& hit) const {
    const float pdf = lights_.pdf(ray.origin, surface_point(scene_, hit, -ray.direction));
    return pdf > 0 ? Part{1, pdf} : Part{};
}

bool BrightSplit::reflects_brightly(const Ray& ray, const Hit& hit) const {
    if (cones().empty()) return false;
    const SurfacePoint p = surface_point(scene_, hit, -ray.direction);
    return field_->is_bright(p.position, p.geometric_normal);
}

const BrightCones& BrightSplit::cones() const {
    static const BrightCones none;
    return field_ ? field_->bright_cones() : none;
}

}  // namespace relumine
