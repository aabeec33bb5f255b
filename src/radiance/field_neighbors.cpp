// SPDX-License-Identifier: Apache-2.0
// Finding neighbours, and weighing them.
#include "radiance/field_neighbors.hpp"

#include <mutex>

#include "base/executor.hpp"

namespace relumine {
namespace {

constexpr float least_cosine = 0.9f;
constexpr float most_height = 0.25f;  // off each other's planes, of the smaller one's size
constexpr float reach = 2;            // of the larger one's size
constexpr float lift = 0.05f;         // of the ray that asks for the way, of the size
constexpr float own_weight = 1e-4f;   // so that there is always some
/// What a first-order irradiance vector is trusted with, of the irradiance that was measured.
constexpr float most_tilted = 2;
constexpr std::size_t run = 256;  // elements of a piece of work

struct Candidate {
    float distance2;
    ElementId id;
};

/// Whether smaller elements know better than `e` what `home` should be blended with.
bool replaced(const FieldElement& e, const FieldElement& home) {
    return e.divided || (e.coarse && !home.coarse);
}

/// Whether two pieces of surface, though not equally large, are parts of one.
bool belong_together(const FieldElement& a, const FieldElement& b) {
    const Vec3 way = b.position - a.position;
    const float larger = std::max(a.size, b.size), height = most_height * std::min(a.size, b.size);
    return dot(a.normal, b.normal) >= least_cosine && length_squared(way) <= sqr(reach * larger)
           && std::abs(dot(way, a.normal)) <= height && std::abs(dot(way, b.normal)) <= height;
}

/// Whether `e` has weight anywhere in the cell of `home`, whose middle is given.
bool reaches(const FieldElement& e, const FieldElement& home, Vec3 middle) {
    const float smaller = std::min(e.size, home.size);
    const float far = 0.5f * (e.size + smaller + home.size) + most_height * smaller;
    const Vec3 way = middle - e.position;
    return std::abs(way.x) < far && std::abs(way.y) < far && std::abs(way.z) < far;
}

bool sees(const Transport& t, const FieldElement& a, const FieldElement& b, RayCounts& rays) {
    const Vec3 from = a.position + a.normal * (a.offset + lift * a.size);
    const Vec3 way = b.position + b.normal * (b.offset + lift * b.size) - from;
    const float distance = length(way);
    if (!(distance > 0)) return true;
    rays.add(RayPurpose::field);
    return !t.tracer.occluded({from, {way / distance}, distance, 0});
}

FieldNeighbors::List find_neighbors(const Transport& t, const FieldCells& cells, ElementId id,
                                    RayCounts& rays) {
    const FieldElement& e = cells.elements()[id];
    const Vec3 middle = cells.middle_of(e);
    std::vector<Candidate> candidates;
    for (int level = e.level - 2; level <= e.level + 2; ++level) {
        if (!cells.has_level(level)) continue;
        cells.around(e.position, level, [&](ElementId other) {
            const FieldElement& o = cells.elements()[other];
            if (other != id && !replaced(o, e) && belong_together(e, o) && reaches(o, e, middle))
                candidates.push_back({length_squared(o.position - e.position), other});
        });
    }
    std::ranges::sort(candidates, [](const Candidate& a, const Candidate& b) {
        return a.distance2 != b.distance2 ? a.distance2 < b.distance2 : a.id < b.id;
    });
    FieldNeighbors::List list;
    list.fill(no_element);
    std::size_t count = 0;
    for (const Candidate& c : candidates) {
        if (count == list.size()) break;
        if (sees(t, e, cells.elements()[c.id], rays)) list[count++] = c.id;
    }
    return list;
}

/// ½ at the border of the element's cell, 1 and 0 half a `ramp` inside and outside, along every axis of the
/// world. With cells of one size, and ramps as wide as they are, a tent and a partition of unity.
float weight_at(const FieldElement& e, Vec3 position, float ramp) {
    Vec3 way = position - e.position;
    way = way - e.normal * dot(way, e.normal);
    const auto axis = [&](float x) {
        return std::clamp((0.5f * (e.size + ramp) - std::abs(x)) / ramp, 0.0f, 1.0f);
    };
    return axis(way.x) * axis(way.y) * axis(way.z);
}

/// How far the light of `b` is that of `a`, by distance and normals.
float likeness(const FieldElement& a, const FieldElement& b) {
    const float distance = length(b.position - a.position) / (2 * std::max(a.size, b.size));
    const float turned = (1 - dot(a.normal, b.normal)) / (1 - least_cosine);
    return std::max(0.0f, 1 - distance) * std::max(0.0f, 1 - turned);
}

}  // namespace

FieldNeighbors::FieldNeighbors(const Transport& t, const FieldCells& cells, int threads, RayCounts& rays)
    : lists_(cells.elements().size()) {
    std::mutex mutex;
    parallel_for(threads, (lists_.size() + run - 1) / run, [&](std::size_t i) {
        RayCounts counts;
        for (std::size_t e = i * run; e < std::min((i + 1) * run, lists_.size()); ++e)
            lists_[e] = find_neighbors(t, cells, static_cast<ElementId>(e), counts);
        const std::lock_guard lock(mutex);
        rays.add(counts);
    });
}

void FieldNeighbors::smooth(const NoisyLight& noisy, int threads, FieldCells& cells) const {
    std::vector<FieldElement>& elements = cells.elements();
    parallel_for(threads, (lists_.size() + run - 1) / run, [&](std::size_t piece) {
        for (std::size_t i = piece * run; i < std::min((piece + 1) * run, lists_.size()); ++i) {
            IrradianceVector mean = noisy.light[i];
            float weights = 1;
            for (const ElementId id : lists_[i]) {
                if (id == no_element) break;
                const float weight = noisy.smoothness[i] * likeness(elements[i], elements[id]);
                mean.add(noisy.light[id], weight);
                weights += weight;
            }
            elements[i].irradiance.add(mean, 1 / weights);
            elements[i].irradiance.add(noisy.light[i], -1);
        }
    });
}

Spectrum FieldNeighbors::irradiance(const FieldCells& cells, ElementId home, Vec3 position,
                                    Vec3 normal) const {
    Spectrum tilted, straight;
    float weights = 0;
    const auto add = [&](const FieldElement& e, float weight) {
        const Spectrum measured = e.irradiance.towards(e.normal);
        weights += weight;
        straight += measured * weight;
        // What the element's vector says of directions along its plane; light from everywhere knows no tilt.
        tilted += (e.irradiance.towards(normal) + measured * (1 - dot(normal, e.normal))) * weight;
    };
    const FieldElement& own = cells.elements()[home];
    add(own, weight_at(own, position, own.size) + own_weight);
    for (const ElementId id : lists_[home]) {
        if (id == no_element) break;
        const FieldElement& e = cells.elements()[id];
        // Where large cells border on small ones, light reaches as far into these as darkness out of them.
        const float weight = weight_at(e, position, std::min(e.size, own.size));
        if (weight > 0) add(e, weight);
    }
    const auto limited = [&](float x, float measured) {
        return std::clamp(x, 0.0f, most_tilted * std::max(measured, 0.0f));
    };
    return Spectrum{limited(tilted.r, straight.r), limited(tilted.g, straight.g),
                    limited(tilted.b, straight.b)}
           * (1 / weights);
}

}  // namespace relumine
