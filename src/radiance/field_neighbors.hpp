// SPDX-License-Identifier: Apache-2.0
// Which elements of a radiance field a point between them is interpolated from.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "base/ray_counts.hpp"
#include "radiance/field_cells.hpp"
#include "radiance/transport.hpp"

namespace relumine {

/// What elements' rays have found, with the noise that few rays leave.
struct NoisyLight {
    std::vector<IrradianceVector> light;  // by element, part of its irradiance
    std::vector<float> smoothness;        // in [0, 1]: how far that around it may stand for it
};

/// For every element the nearest ones that lie in its plane and that it sees.
class FieldNeighbors {
  public:
    static constexpr std::size_t most = 12;
    using List = std::array<ElementId, most>;  // nearest first; ends with no_element

    FieldNeighbors() = default;
    FieldNeighbors(const Transport& t, const FieldCells& cells, int threads, RayCounts& rays);

    /// Irradiance on a surface of this (shading) normal at a point for which `home` stands, by weights
    /// that fall over the borders of their cells.
    [[nodiscard]] Spectrum irradiance(const FieldCells& cells, ElementId home, Vec3 position,
                                      Vec3 normal) const;

    /// Takes the noise out of a part of the elements' light: it becomes a mean over the elements around.
    void smooth(const NoisyLight& noisy, int threads, FieldCells& cells) const;

    [[nodiscard]] const List& of(ElementId element) const { return lists_[element]; }
    [[nodiscard]] std::size_t bytes() const { return lists_.capacity() * sizeof(List); }

  private:
    std::vector<List> lists_;
};

}  // namespace relumine
