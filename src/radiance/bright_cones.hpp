// SPDX-License-Identifier: Apache-2.0
// The bright split once more, behind the first surface: the few pieces of surface that reflect much more
// light than the others (sun on a floor, the inside of a lampshade) as small lights to sample.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "base/frame.hpp"
#include "radiance/field_cells.hpp"

namespace relumine {

/// Spheres around groups of bright elements. A direction is drawn by choosing a sphere, by power over squared
/// distance, and uniformly within the cone that it fills; so every point of a bright element's cell can be
/// drawn, from everywhere, and the density of any direction is known.
class BrightCones {
  public:
    static constexpr std::size_t most = 32;

    BrightCones() = default;
    /// Around the elements that are marked as bright. `radiosity`: by element, luminance in any unit.
    BrightCones(const FieldCells& cells, std::span<const float> radiosity);

    [[nodiscard]] bool empty() const { return spheres_.empty(); }

    /// The spheres as they are seen from one point.
    struct Table {
        std::array<Vec3, most> axis;              // unit
        std::array<float, most> one_less_cosine;  // 1 − the cosine of the cone's half angle; 2: all around
        std::array<float, most> probability;
        std::size_t count = 0;
        bool inside = false;  // of a sphere, or so near that its cone is no help
    };
    /// `normal`: spheres below this horizon are left out.
    [[nodiscard]] Table seen_from(Vec3 position, Vec3 normal) const;

  private:
    struct Sphere {
        Vec3 center;
        float radius, power;
    };
    std::vector<Sphere> spheres_;
};

struct ConeSample {
    WorldDir direction;
    float pdf;  // 1/sr, of `pdf`
};
/// Empty tables have no samples.
[[nodiscard]] ConeSample sample(const BrightCones::Table& table, Point2 u);
/// 1/sr.
[[nodiscard]] float pdf(const BrightCones::Table& table, WorldDir direction);

}  // namespace relumine
