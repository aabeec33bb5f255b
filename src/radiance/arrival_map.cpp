// SPDX-License-Identifier: Apache-2.0
// Drawing directions that light arrives from.
#include "radiance/arrival_map.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace relumine {
namespace {

constexpr auto side_f = static_cast<float>(ArrivalMap::side);
constexpr float below_one = 0x1.fffffep-1f;

std::size_t along(float x) {
    return static_cast<std::size_t>(std::clamp((x + 1) * (0.5f * side_f), 0.0f, side_f - 1));
}

}  // namespace

std::size_t ArrivalMap::cell_of(LocalDir w) { return along(w.v.y) * side + along(w.v.x); }

ArrivalMap::ArrivalMap(std::span<const float> irradiance) {
    const double total = std::accumulate(irradiance.begin(), irradiance.end(), 0.0);
    if (!(total > 0)) return;
    double sum = 0;
    for (std::size_t i = 0; i + 1 < cells; ++i) {
        sum += double{irradiance[i]};
        // One below the whole: `nothing` would begin an empty map, and 2¹⁶ has no place.
        ends_[i] = static_cast<std::uint16_t>(std::min(std::lround(sum / total * all), long{nothing} - 1));
    }
}

std::optional<LocalDir> ArrivalMap::sample(Point2 u) const {
    const float x = u.y * static_cast<float>(all);
    std::size_t row = 0;
    while (row + 1 < side && static_cast<float>(end(row * side + side - 1)) <= x) ++row;
    const auto row_begin = static_cast<float>(begin(row * side)),
               row_width = static_cast<float>(end(row * side + side - 1)) - row_begin;
    const float y = row_begin + u.x * row_width;
    std::size_t cell = row * side;
    while (cell + 1 < (row + 1) * side && static_cast<float>(end(cell)) <= y) ++cell;
    const auto cell_begin = static_cast<float>(begin(cell)),
               cell_width = static_cast<float>(end(cell)) - cell_begin;
    if (!(row_width > 0 && cell_width > 0)) return {};  // rounding at the end of the last row
    const float s = std::clamp((y - cell_begin) / cell_width, 0.0f, below_one),
                t = std::clamp((x - row_begin) / row_width, 0.0f, below_one);
    const float px = 2 * (static_cast<float>(cell % side) + s) / side_f - 1,
                py = 2 * (static_cast<float>(row) + t) / side_f - 1;
    const float cosine2 = 1 - px * px - py * py;
    if (!(cosine2 > 0)) return {};
    return LocalDir{{px, py, std::sqrt(cosine2)}};
}

float ArrivalMap::pdf(LocalDir w) const {
    if (!(w.v.z > 0)) return 0;
    const std::size_t cell = cell_of(w);
    const auto probability = static_cast<float>(end(cell) - begin(cell)) / static_cast<float>(all);
    return probability * (side_f * side_f / 4) * w.v.z;
}

}  // namespace relumine
