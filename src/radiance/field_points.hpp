// SPDX-License-Identifier: Apache-2.0
// Where the rays of an element start: on the surface that its cell holds, most of all where other rays have
// met it. So an element's light is the mean over what asks for it.
#pragma once

#include <span>
#include <vector>

#include "base/ray_counts.hpp"
#include "radiance/field_cells.hpp"
#include "radiance/transport.hpp"

namespace relumine {

/// A place on a surface, on the side of its normal.
struct StartPoint {
    Vec3 position, normal;  // unit, geometric
    float offset = 0;       // metres along the normal that clear rounding errors
};

/// For every element a few of the points that rays have met, each as likely as any other.
class PointReservoirs {
  public:
    static constexpr std::size_t most = 16;

    void offer(ElementId id, const StartPoint& point);
    /// Instead of what was offered.
    void set(ElementId id, std::vector<StartPoint> points);
    [[nodiscard]] std::span<const StartPoint> of(ElementId id) const;

  private:
    struct Reservoir {
        std::uint32_t offered = 0;
        std::vector<StartPoint> points;
    };
    std::vector<Reservoir> reservoirs_;
};

/// Moves an element towards the middle of what its cell holds of the surface, as far as it sees the way.
void center(const Transport& t, const FieldCells& cells, FieldElement& element, RayCounts& rays);

/// The points that were met; where they are few also others, spread over what the element's cell holds of its
/// surface; at least one. Of coarse elements the former alone, if there are any: a coarse cell may hold a
/// floor on both sides of a wall, and rays have met it on the side that asks.
[[nodiscard]] std::vector<StartPoint> start_points(const Transport& t, const FieldCells& cells, ElementId id,
                                                   std::span<const StartPoint> met, std::uint64_t seed,
                                                   RayCounts& rays);

}  // namespace relumine
