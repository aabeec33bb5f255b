// SPDX-License-Identifier: Apache-2.0
// Medians and Morton codes.
#include "radiance/field_scale.hpp"

namespace relumine {
namespace {

float median(std::vector<float>& values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::ranges::nth_element(values, middle);
    return *middle;
}

/// The box of the inner nine tenths along every axis.
Bounds3 core_of(const std::vector<Landing>& landings) {
    Bounds3 core;
    Vec3 lower, upper;
    const auto axis = [&](float Vec3::*x) {
        std::vector<float> values;
        for (const Landing& l : landings) values.push_back(l.position.*x);
        const auto low = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 20);
        const auto high = values.end() - 1 - static_cast<std::ptrdiff_t>(values.size() / 20);
        std::ranges::nth_element(values, low);
        lower.*x = *low;
        std::ranges::nth_element(values, high);
        upper.*x = *high;
    };
    axis(&Vec3::x);
    axis(&Vec3::y);
    axis(&Vec3::z);
    core.add(lower);
    core.add(upper);
    return core;
}

}  // namespace

CellScale scale_of(const Transport& t, const std::vector<Landing>& landings, const FieldSettings& settings) {
    CellScale scale;
    scale.finest = settings.finest;
    if (landings.empty()) return scale;
    std::vector<float> distances;
    for (const Landing& l : landings) distances.push_back(l.distance);
    scale.size = std::max(settings.cell * median(distances), 1e-6f * t.scene.bounds.radius());
    scale.core = core_of(landings);
    return scale;
}

void sort_by_place(std::vector<Landing>& landings, float cell) {
    Bounds3 box;
    for (const Landing& l : landings) box.add(l.position);
    const auto spread = [](float x) {  // ten bits, two zeros after each
        auto i = static_cast<std::uint32_t>(std::clamp(x, 0.0f, 1023.0f));
        i = (i | i << 16) & 0x030000ffu;
        i = (i | i << 8) & 0x0300f00fu;
        i = (i | i << 4) & 0x030c30c3u;
        return (i | i << 2) & 0x09249249u;
    };
    struct Place {
        std::uint32_t code, index;
    };
    std::vector<Place> places;
    for (const Landing& l : landings) {
        const Vec3 at = (l.position - box.lower) * (1 / cell);
        places.push_back({spread(at.x) | spread(at.y) << 1 | spread(at.z) << 2,
                          static_cast<std::uint32_t>(places.size())});
    }
    std::ranges::stable_sort(places, {}, &Place::code);
    std::vector<Landing> sorted;
    sorted.reserve(landings.size());
    for (const Place& p : places) sorted.push_back(landings[p.index]);
    landings = std::move(sorted);
}

}  // namespace relumine
