// SPDX-License-Identifier: Apache-2.0
// The elements of a radiance field by where they are: cubic cells of several sizes, found by hashing.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "base/vec.hpp"

namespace relumine {

/// What arrives at a surface, as a function of its normal: irradiance(n) = n · vector, per channel. Exact for
/// the normal that it was measured with, of first order around it.
struct IrradianceVector {
    Spectrum x, y, z;  // W·m⁻²

    [[nodiscard]] Spectrum towards(Vec3 normal) const { return x * normal.x + y * normal.y + z * normal.z; }
    void add(Vec3 direction, Spectrum amount) {
        x += amount * direction.x;
        y += amount * direction.y;
        z += amount * direction.z;
    }
    void add(const IrradianceVector& other, float times) {
        x += other.x * times;
        y += other.y * times;
        z += other.z * times;
    }
};

using ElementId = std::uint32_t;
inline constexpr ElementId no_element = 0xffffffffu;

/// A piece of surface of about a cell's size, on one side of it.
struct FieldElement {
    Vec3 position, normal;  // normal: geometric, on the side that it stands for
    float size = 0;         // metres, the cell's side
    float offset = 0;       // metres along the normal that clear rounding errors
    std::int8_t level = 0;  // of the cell
    bool divided = false;   // smaller cells may know better
    bool coarse = false;    // stands for what has no cell of its own
    bool bright = false;    // reflects much more than others
    IrradianceVector irradiance;
};

/// Sizes of cells by place: the smallest whole-number multiple of octaves of `size` that grows with the
/// distance from a core.
struct CellScale {
    float size = 0.1f;  // metres, inside the core
    Bounds3 core;
    int finest = 3;  // octaves below the size of a place

    /// Octaves above `size` at `p`, as a level ≤ 0.
    [[nodiscard]] int coarsest_level(Vec3 p) const;
    [[nodiscard]] float size_of(int level) const;
};

/// Elements in cells. Every cell may hold several: other sides, other planes.
class FieldCells {
  public:
    explicit FieldCells(const CellScale& scale);

    [[nodiscard]] const CellScale& scale() const { return scale_; }
    [[nodiscard]] std::vector<FieldElement>& elements() { return elements_; }
    [[nodiscard]] const std::vector<FieldElement>& elements() const { return elements_; }

    /// The finest element that stands for a surface point, or none.
    [[nodiscard]] ElementId find(Vec3 position, Vec3 normal) const;

    /// As `find`; where the finest cell that should stand for the point is empty, makes an element there.
    ElementId find_or_make_fine(Vec3 position, Vec3 normal, float offset);
    /// As `find`; makes an element of a coarse cell where there is none of any size.
    ElementId find_or_make_coarse(Vec3 position, Vec3 normal, float offset);

    /// Whether `position` lies in the cell of `element`.
    [[nodiscard]] bool in_cell_of(const FieldElement& element, Vec3 position) const;
    /// The middle of that cell.
    [[nodiscard]] Vec3 middle_of(const FieldElement& element) const;

    /// Calls `use(id)` for all elements in the 27 cells of `level` around `position`.
    template <typename Use>
    void around(Vec3 position, int level, const Use& use) const {
        const Index home = index_of(position, level);
        for (std::int32_t dz = -1; dz <= 1; ++dz)
            for (std::int32_t dy = -1; dy <= 1; ++dy)
                for (std::int32_t dx = -1; dx <= 1; ++dx)
                    for (ElementId e = first_in({home.x + dx, home.y + dy, home.z + dz, level});
                         e != no_element; e = next_[e])
                        use(e);
    }

    /// Whether any cell of this level holds an element.
    [[nodiscard]] bool has_level(int level) const { return used_levels_[level_index(level)]; }

    [[nodiscard]] std::size_t bytes() const;

  private:
    struct Index {
        std::int32_t x, y, z, level;
    };
    struct Slot {
        std::uint64_t key = 0;  // 0: empty
        ElementId first = no_element;
    };
    struct Place {
        ElementId found = no_element;
        int level = 0;         // where an element is missing
        bool missing = false;  // whether one is
    };

    static constexpr int lowest_level = -24;
    static constexpr std::size_t levels = 48;
    [[nodiscard]] static std::size_t level_index(int level) {
        return static_cast<std::size_t>(level - lowest_level);
    }

    [[nodiscard]] Index index_of(Vec3 position, int level) const;
    [[nodiscard]] static std::uint64_t key_of(const Index& index);
    [[nodiscard]] std::size_t slot_of(std::uint64_t key) const;
    [[nodiscard]] ElementId first_in(const Index& index) const {
        return slots_[slot_of(key_of(index))].first;
    }
    [[nodiscard]] ElementId match(const Index& index, Vec3 position, Vec3 normal) const;
    [[nodiscard]] Place locate(Vec3 position, Vec3 normal) const;
    ElementId make(Vec3 position, Vec3 normal, float offset, int level);
    void grow();

    CellScale scale_;
    std::array<float, levels> cells_per_metre_;  // by level
    std::array<bool, levels> used_levels_{};
    std::vector<FieldElement> elements_;
    std::vector<ElementId> next_;  // in the same cell
    std::vector<Slot> slots_;      // a power of two, open addressing
    std::size_t used_ = 0;
};

}  // namespace relumine
