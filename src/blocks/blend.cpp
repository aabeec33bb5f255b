// SPDX-License-Identifier: Apache-2.0
// Weighing maps.
#include "blocks/blend.hpp"

namespace relumine {
namespace {

constexpr float least_cos_normals = 0.8f,
                full_cos_normals = 0.95f;  // a map's weight rises from 0 to 1 between
constexpr float plane_tolerance = 0.5f;    // off a map's plane, against its block's side: weight 0

float tent(float distance, float reach) { return std::max(0.0f, 1 - std::abs(distance) / reach); }

float weight_of(const CachePoint& point, const BlockMap& map) {
    const float x = static_cast<float>(point.x) + 0.5f, y = static_cast<float>(point.y) + 0.5f;
    const float near = tent(x - map.center_x, map.size) * tent(y - map.center_y, map.size);
    if (near <= 0 || point.gather.depth != map.anchor.depth) return 0;
    const float cosine = dot(point.gather.frame.n, map.anchor.frame.n);
    const float alike = (cosine - least_cos_normals) / (full_cos_normals - least_cos_normals);
    if (alike <= 0) return 0;
    const float off = dot(point.gather.position - map.anchor.position, map.anchor.frame.n);
    const float reach = plane_tolerance * map.size * std::max(point.footprint, map.footprint);
    return near * std::min(alike, 1.0f) * tent(off, reach);
}

}  // namespace

void Blend::add(const BlockMap& map, float weight) {
    if (count_ < most) {
        maps_[count_++] = {&map, weight};
        return;
    }
    WeightedMap& least = *std::ranges::min_element(maps_, {}, &WeightedMap::weight);
    if (weight > least.weight) least = {&map, weight};
}

float Blend::smallest_block() const {
    float least = infinity;
    for (const WeightedMap& m : maps()) least = std::min(least, m.map->size);
    return least;
}

void Blend::normalize() {
    float sum = 0;
    for (const WeightedMap& m : maps()) sum += m.weight;
    for (std::size_t i = 0; i < count_; ++i) maps_[i].weight /= sum;
}

void Blend::keep_heaviest() {
    if (empty()) return;
    maps_[0] = *std::ranges::max_element(maps(), {}, &WeightedMap::weight);
    maps_[0].weight = 1;
    count_ = 1;
}

Blend blend_maps(const CachePoint& point, std::span<const BlockMap* const> candidates) {
    Blend blend;
    for (const BlockMap* map : candidates)
        if (const float weight = weight_of(point, *map); weight > 0) blend.add(*map, weight);
    blend.normalize();
    return blend;
}

}  // namespace relumine
