// SPDX-License-Identifier: Apache-2.0
// Irradiance gradients by strata.
//
// A stratum's border that runs along an edge at distance r moves, seen from a point that moves by dx, against
// the point: by dx cos θ / r in θ and by dx / (r sin θ) in φ. The strata's projected solid angles change with
// their borders, and the nearer of two neighbours is the one whose edge it is [Ward92; Krivanek09].
#include "rivals/irradiance.hpp"

namespace relumine {
namespace {

using Part = Spectrum PolarSample::*;

/// How much of the light changes over a border, per metre of move: 0 where the border is the surface itself.
Spectrum change_over(const PolarSample& from, const PolarSample& to, Part part) {
    const float nearer = std::min(from.distance, to.distance);
    if (!from.open || !to.open || !(nearer < infinity)) return {};
    return (to.*part - from.*part) / nearer;
}

/// Borders between rings move along the sector's azimuth.
void add_rings(const PolarHemisphere& h, int sector, Part part, Vec3 along, Gradient& sum) {
    const float width = 2 * pi / static_cast<float>(h.grid.sectors);
    for (int ring = 1; ring < h.grid.rings; ++ring) {
        const float cosine = h.grid.cosine(static_cast<float>(ring));
        const float moved = width * std::sqrt(1 - sqr(cosine)) * sqr(cosine);
        sum.add(change_over(h.at(ring - 1, sector), h.at(ring, sector), part) * moved, along);
    }
}

/// Borders between sectors move across their azimuth.
void add_sectors(const PolarHemisphere& h, int sector, Part part, Vec3 across, Gradient& sum) {
    const int before = (sector + h.grid.sectors - 1) % h.grid.sectors;
    float above = 0;  // sin θ of the ring's upper border
    for (int ring = 0; ring < h.grid.rings; ++ring) {
        const float below = std::sqrt(1 - sqr(h.grid.cosine(static_cast<float>(ring + 1))));
        sum.add(change_over(h.at(ring, before), h.at(ring, sector), part) * (below - above), across);
        above = below;
    }
}

Irradiance part_of(const PolarHemisphere& h, const Frame& frame, Part part) {
    Irradiance e;
    for (const PolarSample& s : h.samples) e.value += s.*part;
    const float count = static_cast<float>(h.grid.size());
    const Spectrum mean = e.value / count;
    e.value *= pi / count;
    for (const PolarSample& s : h.samples) {
        // n × ω over the density, which is proportional to the cosine. The mean light adds nothing to the
        // integral, but the tangents along the horizon would make much noise of it.
        const Vec3 turned = frame.t * s.direction.v.x - frame.s * s.direction.v.y;
        e.rotation.add((s.*part - mean) * (pi / (count * std::max(cos_theta(s.direction), 1e-3f))), turned);
    }
    for (int sector = 0; sector < h.grid.sectors; ++sector) {
        const float middle = h.grid.azimuth(static_cast<float>(sector) + 0.5f),
                    border = h.grid.azimuth(static_cast<float>(sector));
        const Vec3 along = frame.s * std::cos(middle) + frame.t * std::sin(middle),
                   across = frame.t * std::cos(border) - frame.s * std::sin(border);
        add_rings(h, sector, part, along, e.translation);
        add_sectors(h, sector, part, across, e.translation);
    }
    return e;
}

}  // namespace

SplitIrradiance irradiance_of(const PolarHemisphere& hemisphere, const Frame& frame) {
    return {part_of(hemisphere, frame, &PolarSample::direct),
            part_of(hemisphere, frame, &PolarSample::indirect)};
}

Spectrum extrapolated(const Irradiance& at, Vec3 record_normal, Vec3 offset, Vec3 normal) {
    const Spectrum e =
        at.value + at.rotation.along(cross(record_normal, normal)) + at.translation.along(offset);
    return {std::max(e.r, 0.0f), std::max(e.g, 0.0f), std::max(e.b, 0.0f)};
}

float change_length(const SplitIrradiance& at) {
    const auto brightness = [](const Gradient& g) { return 0.2126f * g.r + 0.7152f * g.g + 0.0722f * g.b; };
    const float change = length(brightness(at.direct.translation) + brightness(at.indirect.translation));
    return change > 0 ? luminance(at.value()) / change : infinity;
}

}  // namespace relumine
