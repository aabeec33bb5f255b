// SPDX-License-Identifier: Apache-2.0
// Where the light on a piece of surface comes from, as a distribution that directions can be drawn from.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "base/frame.hpp"

namespace relumine {

/// A hemisphere in cells of equal irradiance under even light: squares of the plane that directions above a
/// surface are projected on (Nusselt's analogue). Within a cell directions are drawn in proportion to cos θ.
/// The density is exact whatever was put in: probabilities are whole numbers over 2¹⁶.
class ArrivalMap {
  public:
    static constexpr std::size_t side = 16, cells = side * side;

    ArrivalMap() = default;  // nothing is known: no directions
    /// `irradiance`: by cell, ≥ 0.
    explicit ArrivalMap(std::span<const float> irradiance);

    [[nodiscard]] bool empty() const { return ends_[0] == nothing; }
    /// Empty where the point drawn lies beyond the horizon, as parts of the cells there do. Not of empty
    /// maps.
    [[nodiscard]] std::optional<LocalDir> sample(Point2 u) const;
    /// Density of `sample`, per steradian.
    [[nodiscard]] float pdf(LocalDir w) const;

    [[nodiscard]] static std::size_t cell_of(LocalDir w);

  private:
    static constexpr std::uint32_t all = 1u << 16;
    static constexpr std::uint16_t nothing = 0xffff;

    /// Where a cell's probability ends among those of all cells, row by row; the last one's end is `all`.
    [[nodiscard]] std::uint32_t end(std::size_t cell) const { return cell + 1 == cells ? all : ends_[cell]; }
    [[nodiscard]] std::uint32_t begin(std::size_t cell) const { return cell == 0 ? 0 : ends_[cell - 1]; }

    std::array<std::uint16_t, cells - 1> ends_{nothing};
};

}  // namespace relumine
