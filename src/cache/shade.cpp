// SPDX-License-Identifier: Apache-2.0
// Tabulating BSDFs and summing reflected light.
#include "cache/shade.hpp"

#include <algorithm>
#include <cstddef>

#include "base/rgbe.hpp"
#include "cache/cell_sum_kernel.hpp"
#include "cache/hemisphere_map.hpp"

namespace relumine {
namespace {

constexpr std::size_t fine_points = 16;  // per fine cell: 4 in each of its bits
constexpr float narrow_lobe = 0.3f;      // GGX α along either axis; wider lobes vary little within a cell
constexpr float wide_lobe = 0.4f;        // still wider ones, little within 2 × 2 cells
constexpr float greatest_curvature =
    0.3f;  // of the BSDF over a cell, against its value, before the cell counts as fine

struct DirectionTable {
    std::vector<float> x, y, z;

    explicit DirectionTable(std::size_t count) : x(count), y(count), z(count) {}
    void set(std::size_t i, LocalDir w) {
        x[i] = w.v.x;
        y[i] = w.v.y;
        z[i] = w.v.z;
    }
    [[nodiscard]] Directions span(std::size_t first, std::size_t count) const {
        return {{&x[first], count}, {&y[first], count}, {&z[first], count}};
    }
};

/// Directions through the centres of the cells.
const DirectionTable& cell_centers() {
    static const DirectionTable table = [] {
        DirectionTable t(cell_count);
        for (std::size_t i = 0; i < cell_count; ++i) {
            const auto x = static_cast<float>(i % cell_side), y = static_cast<float>(i / cell_side);
            t.set(i, square_to_hemisphere({(x + 0.5f) / cell_side, (y + 0.5f) / cell_side}));
        }
        return t;
    }();
    return table;
}

/// Of tiles of 2 × 2 cells the means of their cells' directions, a little shorter than 1: what is linear in
/// the direction, as a cosine is, loses nothing.
const DirectionTable& tile_directions() {
    static const DirectionTable table = [] {
        constexpr std::size_t side = cell_side / 2;
        const DirectionTable& cells = cell_centers();
        DirectionTable t(side * side);
        for (std::size_t i = 0; i < side * side; ++i) {
            const std::size_t first = i / side * 2 * cell_side + i % side * 2;
            const auto mean = [&](const std::vector<float>& v) {
                return 0.25f * (v[first] + v[first + 1] + v[first + cell_side] + v[first + cell_side + 1]);
            };
            t.set(i, {{mean(cells.x), mean(cells.y), mean(cells.z)}});
        }
        return t;
    }();
    return table;
}

/// Directions through 4 × 4 points of each cell, cell by cell and bit by bit.
const DirectionTable& fine_directions() {
    static const DirectionTable table = [] {
        DirectionTable t(cell_count * fine_points);
        for (std::size_t i = 0; i < cell_count * fine_points; ++i) {
            const std::size_t cell = i / fine_points, bit = i / 4 % 4, point = i % 4;
            const auto along = [&](std::size_t cell_index, std::size_t bit_index, std::size_t point_index) {
                const auto quarter = static_cast<float>(2 * bit_index + point_index) + 0.5f;
                return (static_cast<float>(cell_index) + quarter / 4) / cell_side;
            };
            t.set(i, square_to_hemisphere({along(cell % cell_side, bit % 2, point % 2),
                                           along(cell / cell_side, bit / 2, point / 2)}));
        }
        return t;
    }();
    return table;
}

/// The fine cells' directions one after the other, so that one call of the kernel evaluates them all.
Directions gather_fine_directions(BsdfTable& table, std::size_t count) {
    const DirectionTable& all = fine_directions();
    table.scratch.resize(6 * count);
    const std::array planes{all.x.data(), all.y.data(), all.z.data()};
    for (std::size_t axis = 0; axis < planes.size(); ++axis)
        for (std::size_t i = 0; i < table.fine_cells.size(); ++i)
            std::copy_n(planes[axis] + table.fine_cells[i] * fine_points, fine_points,
                        &table.scratch[axis * count + i * fine_points]);
    const std::span<const float> scratch(table.scratch);
    return {scratch.subspan(0, count), scratch.subspan(count, count), scratch.subspan(2 * count, count)};
}

void refine(const ReceiverBsdf& bsdf, BsdfTable& table) {
    const std::size_t count = table.fine_cells.size() * fine_points;
    const Directions directions = gather_fine_directions(table, count);
    const std::span<float> out = std::span(table.scratch).subspan(3 * count);
    const SpectrumArrays values{out.subspan(0, count), out.subspan(count, count),
                                out.subspan(2 * count, count)};
    evaluate(bsdf, directions, values);
    for (std::size_t i = 0; i < count; i += 4) {
        const auto mean = [&](std::span<const float> v) {
            return 0.25f * ((v[i] + v[i + 1]) + (v[i + 2] + v[i + 3]));
        };
        table.fine_bits.emplace_back(mean(values.r), mean(values.g), mean(values.b));
    }
    for (const std::uint32_t cell : table.fine_cells) table.r[cell] = table.g[cell] = table.b[cell] = 0;
}

bool is_as_wide(const ReceiverBsdf& bsdf, float alpha) { return least_width(bsdf) >= alpha; }

Spectrum fine_cell_sum(const std::vector<std::uint32_t>& radiance, const Mask& lit, const BsdfTable& table,
                       std::size_t fine) {
    const std::uint32_t cell = table.fine_cells[fine];
    const std::size_t first_x = cell % cell_side * 2, first_y = cell / cell_side * 2;
    Spectrum sum;
    for (std::size_t bit = 0; bit < 4; ++bit) {
        const std::size_t x = first_x + bit % 2, y = first_y + bit / 2;
        if (lit.test(static_cast<int>(x), static_cast<int>(y)))
            sum += unpack_rgbe(radiance[y * mask_side + x]) * table.fine_bits[4 * fine + bit];
    }
    return sum;
}

Spectrum reflected(const std::vector<std::uint32_t>& radiance, const Mask& lit, const BsdfTable& table,
                   std::span<float> products) {
    Spectrum sum = sum_cells(radiance, lit, {table.r, table.g, table.b}, products);
    for (std::size_t fine = 0; fine < table.fine_cells.size(); ++fine) {
        const Spectrum share = fine_cell_sum(radiance, lit, table, fine);
        if (!products.empty()) products[table.fine_cells[fine]] = luminance(share);
        sum += share;
    }
    return sum;
}

}  // namespace

void tabulate(const ReceiverBsdf& bsdf, const CellMask& cells, BsdfTable& table) {
    table.r.resize(cell_count);
    table.g.resize(cell_count);
    table.b.resize(cell_count);
    table.fine_cells.clear();
    table.fine_bits.clear();
    const Directions centers = cell_centers().span(0, cell_count);
    if (is_as_wide(bsdf, narrow_lobe)) {
        evaluate_cells(bsdf, centers, cells, {table.r, table.g, table.b});
        return;
    }
    evaluate_cells(bsdf, centers, with_neighbours(cells), {table.r, table.g, table.b});
    // A cell's centre does not stand for its mean by about a 24th of the curvature.
    find_curved_cells(table.g, cells, greatest_curvature, table.fine_cells);
    refine(bsdf, table);
}

ReflectedRadiance shade(const Reprojection& incident, const BsdfTable& table, std::span<float> products) {
    const Spectrum total = reflected(incident.radiance, incident.lit, table, products) * bit_solid_angle;
    for (float& product : products) product *= bit_solid_angle;
    if (incident.direct.empty()) return {total, total};
    return {total, reflected(incident.direct, incident.lit, table, {}) * bit_solid_angle};
}

ReflectedRadiance shade(const Reprojection& incident, const ReceiverBsdf& bsdf, BsdfTable& scratch,
                        std::span<float> products) {
    if (!is_as_wide(bsdf, wide_lobe) || !incident.direct.empty() || !products.empty()) {
        tabulate(bsdf, cells_of(incident.lit), scratch);
        return shade(incident, scratch, products);
    }
    const DirectionTable& directions = tile_directions();
    const Spectrum sum =
        reflect_tiles(bsdf, directions.span(0, directions.x.size()), incident.radiance, incident.lit)
        * bit_solid_angle;
    return {sum, sum};
}

}  // namespace relumine
