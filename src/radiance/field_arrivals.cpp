// SPDX-License-Identifier: Apache-2.0
// Adding up maps of arriving light.
#include "radiance/field_arrivals.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/executor.hpp"

namespace relumine {
namespace {

constexpr float most_sky_share = 0.5f;  // of samples of the lights: the rest goes where no ray has been

/// Whether their maps may be added: frames flip where normals pass through the equator.
bool in_one_plane(const FieldElement& a, const FieldElement& b) {
    const Frame f = frame_around(a.normal), g = frame_around(b.normal);
    constexpr float least_cosine = 0.99f;
    return dot(f.s, g.s) > least_cosine && dot(f.n, g.n) > least_cosine
           && std::abs(dot(b.position - a.position, a.normal)) < 0.5f * a.size;
}

}  // namespace

void StraightLight::add(Vec3 normal, float light, std::span<const Sight> sky) {
    lights_.push_back(light);
    const std::size_t first = sky_.size();
    sky_.resize(first + ArrivalMap::cells);
    const Frame frame = frame_around(normal);
    for (const Sight& s : sky)
        sky_[first + ArrivalMap::cell_of(frame.to_local({s.direction}))] += s.irradiance;
}

void StraightLight::resize(std::size_t elements) {
    lights_.resize(elements);
    sky_.resize(elements * ArrivalMap::cells);
}

std::vector<ElementArrivals> make_arrivals(const FieldCells& cells, const FieldLinks& links,
                                           std::span<const Spectrum> irradiance, float share,
                                           const StraightLight& straight, int threads) {
    const std::vector<FieldElement>& elements = cells.elements();
    std::vector<float> linked(elements.size() * ArrivalMap::cells);  // W·m⁻², by element and cell of its map
    parallel_for(threads, elements.size(), [&](std::size_t i) {
        for (const Link& l : links.of(i))
            linked[i * ArrivalMap::cells + ArrivalMap::cell_of(unpack_direction(l.direction))] +=
                std::max(0.0f, luminance(l.value() * irradiance[l.to]) * share);
    });
    std::vector<ElementArrivals> arrivals(elements.size());
    parallel_for(threads, elements.size(), [&](std::size_t i) {
        std::array<float, ArrivalMap::cells> surfaces{}, sky{};
        float light = 0, sky_light = 0;
        cells.around(elements[i].position, elements[i].level, [&](ElementId other) {
            if (!in_one_plane(elements[i], elements[other])) return;
            const std::span<const float> seen = straight.sky_of(other);
            for (std::size_t c = 0; c < ArrivalMap::cells; ++c) {
                surfaces[c] += linked[other * ArrivalMap::cells + c];
                sky[c] += seen[c];
                sky_light += seen[c];
            }
            light += straight.of(other);
        });
        arrivals[i] = {ArrivalMap(surfaces), ArrivalMap(sky), 0};
        if (sky_light > 0)
            arrivals[i].sky_share = std::min(sky_light / std::max(light, sky_light), most_sky_share);
    });
    return arrivals;
}

}  // namespace relumine
