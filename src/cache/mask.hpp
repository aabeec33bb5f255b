// SPDX-License-Identifier: Apache-2.0
// Bit masks over the receiver's square: 128 × 128 bits, whole rows at a time [V, §3.3–3.4].
#pragma once

#include <array>
#include <bit>
#include <cstdint>

namespace relumine {

inline constexpr int mask_side = 128;
inline constexpr int mask_bits = mask_side * mask_side;

/// 128 bits; bit x of the row is bit x of `low`, or bit x − 64 of `high`.
struct MaskRow {
    std::uint64_t low = 0, high = 0;

    friend constexpr MaskRow operator&(MaskRow a, MaskRow b) { return {a.low & b.low, a.high & b.high}; }
    friend constexpr MaskRow operator|(MaskRow a, MaskRow b) { return {a.low | b.low, a.high | b.high}; }
    friend constexpr MaskRow operator~(MaskRow a) { return {~a.low, ~a.high}; }
    bool operator==(const MaskRow&) const = default;

    [[nodiscard]] constexpr bool any() const { return (low | high) != 0; }
    [[nodiscard]] constexpr bool test(int x) const {
        return ((x < 64 ? low >> x : high >> (x - 64)) & 1) != 0;
    }
    [[nodiscard]] constexpr int count() const { return std::popcount(low) + std::popcount(high); }
    /// `length` ≤ 32 bits from bit x on; bits past the row's end are 0.
    [[nodiscard]] constexpr std::uint32_t bits(int x, int length) const {
        const std::uint64_t from = x >= 64  ? high >> (x - 64)
                                   : x == 0 ? low
                                            : (low >> x) | (high << (64 - x));
        return static_cast<std::uint32_t>(from & ((std::uint64_t{1} << length) - 1));
    }
};

namespace detail {
inline constexpr auto rows_of_bits_below = [] {
    std::array<MaskRow, mask_side + 1> rows{};
    for (std::size_t x = 0; x < mask_side; ++x) {
        rows[x + 1] = rows[x];
        (x < 64 ? rows[x + 1].low : rows[x + 1].high) |= std::uint64_t{1} << x % 64;
    }
    return rows;
}();
}  // namespace detail

/// The bits below x, x in [0, 128].
constexpr const MaskRow& bits_below(int x) { return detail::rows_of_bits_below[static_cast<std::size_t>(x)]; }

/// The bits x0 ≤ x < x1.
constexpr MaskRow bit_span(int x0, int x1) { return bits_below(x1) & ~bits_below(x0); }

/// A half-open rectangle of bits inside the mask.
struct BitRect {
    std::uint8_t x0 = 0, x1 = 0, y0 = 0, y1 = 0;

    [[nodiscard]] constexpr bool empty() const { return x0 >= x1 || y0 >= y1; }
    [[nodiscard]] constexpr int width() const { return x1 - x0; }
    [[nodiscard]] constexpr int height() const { return y1 - y0; }
    bool operator==(const BitRect&) const = default;
};

struct alignas(64) Mask {
    std::array<MaskRow, mask_side> rows{};

    [[nodiscard]] bool test(int x, int y) const { return rows[static_cast<std::size_t>(y)].test(x); }
    [[nodiscard]] int count() const {
        // Byte by byte over 16 rows, at most 128 each: many words at a time where there is no instruction for
        // it.
        int sum = 0;
        for (std::size_t y = 0; y < mask_side; y += 16) {
            std::uint64_t low = 0, high = 0;
            for (std::size_t i = y; i < y + 16; ++i) {
                low += counts_of_bytes(rows[i].low);
                high += counts_of_bytes(rows[i].high);
            }
            const std::uint64_t even = 0x00ff00ff00ff00ff;
            const std::uint64_t pairs = (low & even) + (low >> 8 & even) + (high & even) + (high >> 8 & even);
            sum += static_cast<int>(pairs * 0x0001000100010001 >> 48);
        }
        return sum;
    }
    void fill(const BitRect& rect) {
        if (rect.empty()) return;
        const MaskRow span = bit_span(rect.x0, rect.x1);
        for (std::size_t y = rect.y0; y < rect.y1; ++y) rows[y] = rows[y] | span;
    }
    friend Mask operator&(const Mask& a, const Mask& b) {
        Mask out;
        for (std::size_t y = 0; y < mask_side; ++y) out.rows[y] = a.rows[y] & b.rows[y];
        return out;
    }
    friend Mask operator|(const Mask& a, const Mask& b) {
        Mask out;
        for (std::size_t y = 0; y < mask_side; ++y) out.rows[y] = a.rows[y] | b.rows[y];
        return out;
    }
    friend Mask operator~(const Mask& a) {
        Mask out;
        for (std::size_t y = 0; y < mask_side; ++y) out.rows[y] = ~a.rows[y];
        return out;
    }
    bool operator==(const Mask&) const = default;

  private:
    /// How many bits of each byte are set.
    static constexpr std::uint64_t counts_of_bytes(std::uint64_t bits) {
        bits -= bits >> 1 & 0x5555555555555555;
        bits = (bits & 0x3333333333333333) + (bits >> 2 & 0x3333333333333333);
        return (bits + (bits >> 4)) & 0x0f0f0f0f0f0f0f0f;
    }
};

/// A mask by halves of 64 columns: few rectangles touch both, and a vector holds twice as many rows of a
/// half.
struct alignas(64) SplitMask {
    std::array<std::array<std::uint64_t, mask_side>, 2>
        halves{};  // columns from 0 and from 64 on, row by row

    SplitMask() = default;
    explicit SplitMask(const Mask& mask) {
        for (std::size_t y = 0; y < mask_side; ++y) {
            halves[0][y] = mask.rows[y].low;
            halves[1][y] = mask.rows[y].high;
        }
    }
    [[nodiscard]] Mask joined() const {
        Mask mask;
        for (std::size_t y = 0; y < mask_side; ++y) mask.rows[y] = {halves[0][y], halves[1][y]};
        return mask;
    }
};

/// A bit for each cell of 2 × 2 bits, row by row.
using CellMask = std::array<std::uint64_t, mask_side / 2>;

inline constexpr CellMask all_cells = [] {
    CellMask cells{};
    cells.fill(~std::uint64_t{0});
    return cells;
}();

/// The cells that have a bit of the mask.
inline CellMask cells_of(const Mask& mask) {
    const auto either_of_pairs = [](std::uint64_t bits) {
        bits = (bits | bits >> 1) & 0x5555555555555555;
        bits = (bits | bits >> 1) & 0x3333333333333333;
        bits = (bits | bits >> 2) & 0x0f0f0f0f0f0f0f0f;
        bits = (bits | bits >> 4) & 0x00ff00ff00ff00ff;
        bits = (bits | bits >> 8) & 0x0000ffff0000ffff;
        return (bits | bits >> 16) & 0x00000000ffffffff;
    };
    CellMask cells;
    for (std::size_t y = 0; y < cells.size(); ++y) {
        const MaskRow both = mask.rows[2 * y] | mask.rows[2 * y + 1];
        cells[y] = either_of_pairs(both.low) | either_of_pairs(both.high) << 32;
    }
    return cells;
}

/// These cells and the four beside each.
inline CellMask with_neighbours(const CellMask& cells) {
    CellMask wide;
    for (std::size_t y = 0; y < cells.size(); ++y) {
        const std::uint64_t above = y > 0 ? cells[y - 1] : 0, below = y + 1 < cells.size() ? cells[y + 1] : 0;
        wide[y] = cells[y] | cells[y] << 1 | cells[y] >> 1 | above | below;
    }
    return wide;
}

}  // namespace relumine
