// SPDX-License-Identifier: Apache-2.0
// Masks: rows of 128 bits.
#include "cache/mask.hpp"

#include <gtest/gtest.h>

namespace relumine {
namespace {

TEST(Mask, SpansHoldTheirBitsAlone) {
    for (int x0 = 0; x0 <= mask_side; ++x0)
        for (int x1 = x0; x1 <= mask_side; ++x1) {
            const MaskRow span = bit_span(x0, x1);
            ASSERT_EQ(span.count(), x1 - x0);
            ASSERT_TRUE(x0 == x1 || (span.test(x0) && span.test(x1 - 1)));
        }
}

TEST(Mask, BitsCrossTheMiddleOfTheRow) {
    const MaskRow row = bit_span(60, 70);
    EXPECT_EQ(row.bits(60, 10), 0x3ffu);
    EXPECT_EQ(row.bits(56, 8), 0xf0u);
    EXPECT_EQ(row.bits(64, 8), 0x3fu);
    EXPECT_EQ(bit_span(120, 128).bits(120, 16), 0xffu);
}

TEST(Mask, FillsRectangles) {
    Mask mask;
    mask.fill({10, 100, 3, 5});
    EXPECT_EQ(mask.count(), 180);
    EXPECT_TRUE(mask.test(10, 3));
    EXPECT_FALSE(mask.test(9, 3));
    EXPECT_FALSE(mask.test(10, 5));
    mask.fill({20, 20, 0, 128});
    EXPECT_EQ(mask.count(), 180);
    EXPECT_EQ((~mask).count() + mask.count(), mask_bits);
}

TEST(Mask, CellsAreThoseOfTwoByTwoBits) {
    Mask mask;
    mask.fill({5, 6, 9, 10});
    mask.fill({60, 69, 100, 103});
    mask.fill({127, 128, 127, 128});
    const CellMask cells = cells_of(mask), wide = with_neighbours(cells);
    const auto has = [](const CellMask& c, int x, int y) {
        return x >= 0 && y >= 0 && x < 64 && y < 64 && (c[static_cast<std::size_t>(y)] >> x & 1) != 0;
    };
    for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 64; ++x) {
            const bool any = mask.test(2 * x, 2 * y) || mask.test(2 * x + 1, 2 * y)
                             || mask.test(2 * x, 2 * y + 1) || mask.test(2 * x + 1, 2 * y + 1);
            ASSERT_EQ(has(cells, x, y), any) << x << " " << y;
            ASSERT_EQ(has(wide, x, y), any || has(cells, x - 1, y) || has(cells, x + 1, y)
                                           || has(cells, x, y - 1) || has(cells, x, y + 1))
                << x << " " << y;
        }
    EXPECT_EQ(cells_of(~Mask{}), all_cells);
}

}  // namespace
}  // namespace relumine
