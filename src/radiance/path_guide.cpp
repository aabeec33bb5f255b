// SPDX-License-Identifier: Apache-2.0
// Drawing guided directions.
#include "radiance/path_guide.hpp"

#include "radiance/arrival_map.hpp"
#include "radiance/lobe_walk.hpp"
#include "shading/reflectance.hpp"

namespace relumine {
namespace {

/// How much of what a BSDF reflects has no sharp lobe, [0, 1]: maps know nothing of lobes.
float diffuse_share(const Vertex& vertex) {
    if (std::holds_alternative<Lambert>(vertex.bsdf)) return 1;
    const LobeSplit split = split_lobes(vertex.bsdf, vertex.w_out);
    if (split.transmits) return 0;
    const float diffuse = max_component(split.diffuse), glossy = max_component(split.glossy);
    if (split.alpha >= rough_alpha) return 1;
    return diffuse > 0 ? diffuse / (diffuse + glossy) : 0;
}

}  // namespace

PathGuide::PathGuide(const PlacedArrivals& arrivals, const Vertex& vertex, float share)
    : arrivals_(arrivals),
      normal_(vertex.point.frame.n),
      share_(arrivals.surfaces && !arrivals.surfaces->empty() ? share * diffuse_share(vertex) : 0) {
    if (!arrivals.sky || arrivals.sky->empty()) arrivals_.sky_share = 0;
}

float PathGuide::sky_pdf(WorldDir direction) const {
    const float share = arrivals_.sky_share;
    return share > 0 ? share * arrivals_.sky->pdf(arrivals_.frame.to_local(direction)) : 0;
}

std::optional<LightSample> PathGuide::sample_light(const LightSampler& lights, Vec3 from, Point2 u) const {
    const float share = arrivals_.sky_share;
    if (share > 0 && u.x < share) {
        const auto drawn = arrivals_.sky->sample({u.x / share, u.y});
        if (!drawn) return {};
        LightSample light;
        light.w_in = arrivals_.frame.to_world(*drawn);
        light.radiance = lights.environment_radiance(light.w_in);
        light.pdf = light_share() * lights.environment_pdf(light.w_in) + sky_pdf(light.w_in);
        return light;
    }
    auto light = lights.sample(from, {std::min((u.x - share) / (1 - share), 0x1.fffffep-1f), u.y});
    if (!light) return {};
    light->pdf *= light_share();
    if (!light->delta && !std::isfinite(light->distance)) light->pdf += sky_pdf(light->w_in);
    return light;
}

float PathGuide::pdf(WorldDir direction, float bsdf_pdf) const {
    if (share_ == 0) return bsdf_pdf;
    const float guided =
        is_above(direction) ? arrivals_.surfaces->pdf(arrivals_.frame.to_local(direction)) : 0;
    return (1 - share_) * bsdf_pdf + share_ * guided;
}

std::optional<BsdfSample> PathGuide::sample(const Vertex& vertex, BsdfRandom u) const {
    WorldDir direction{};
    float eta = 1;  // maps lie on the viewer's side
    if (u.lobe < share_) {
        const auto drawn = arrivals_.surfaces->sample(u.direction);
        if (!drawn) return {};
        direction = arrivals_.frame.to_world(*drawn);
        if (!is_above(direction)) return {};
    } else {
        // What choosing leaves of the number chooses the lobe.
        u.lobe = std::min((u.lobe - share_) / (1 - share_), 0x1.fffffep-1f);
        auto scattered = relumine::sample(vertex.bsdf, vertex.w_out, u);
        if (!scattered || share_ == 0) return scattered;
        if (scattered->delta) {
            scattered->weight *= 1 / (1 - share_);
            scattered->pdf *= 1 - share_;
            return scattered;
        }
        direction = vertex.point.frame.to_world(scattered->w_in);
        eta = scattered->eta;
    }
    const LocalDir w_in = vertex.point.frame.to_local(direction);
    const BsdfValue bsdf = evaluate(vertex.bsdf, vertex.w_out, w_in);
    const float density = pdf(direction, bsdf.pdf);
    if (!(density > 0)) return {};
    return BsdfSample{w_in, bsdf.value / density, density, false, eta};
}

}  // namespace relumine
