// SPDX-License-Identifier: Apache-2.0
// Sums over cells against their scalar definitions, on every instruction set that this machine has; built a
// second time with one lane alone (tests/CMakeLists.txt).
#include "cache/cell_sum_kernel.hpp"

#include <gtest/gtest.h>

#include "base/rgbe.hpp"
#include "cache/receiver_bsdf.hpp"
#include "cache/test_random.hpp"
#include "tests/targets.hpp"

namespace relumine {
namespace {

using testing::on_every_target;
using testing::random_direction;
using testing::uniform;

TEST(CellSumKernel, AgreesWithItsDefinitionOnEveryTarget) {
    constexpr std::size_t cells = mask_bits / 4, side = mask_side / 2;
    std::vector<std::uint32_t> radiance(mask_bits);
    std::vector<float> r(cells), g(cells), b(cells);
    Mask lit = ~Mask{};
    lit.rows[8] = lit.rows[9] = lit.rows[20] = {};
    lit.rows[30] = bit_span(3, 70);
    for (std::size_t i = 0; i < radiance.size(); ++i)
        if (i % 7 != 0)
            radiance[i] = pack_rgbe({uniform(i, 1, 0, 5), uniform(i, 2, 0, 1), uniform(i, 3, 0, 1e-3f)});
    for (std::size_t i = 0; i < cells; ++i)
        r[i] = uniform(i, 4, 0, 1), g[i] = uniform(i, 5, 0, 1), b[i] = uniform(i, 6, 0, 1);
    Spectrum expected;
    std::vector<float> products(cells);
    for (std::size_t i = 0; i < cells; ++i) {
        const std::size_t bit = i / side * 2 * mask_side + i % side * 2;
        const auto light = [&](std::size_t at) {
            const bool seen = lit.test(static_cast<int>(at % mask_side), static_cast<int>(at / mask_side));
            return seen ? unpack_rgbe(radiance[at]) : Spectrum{};
        };
        const Spectrum sum =
            light(bit) + light(bit + 1) + light(bit + mask_side) + light(bit + mask_side + 1);
        expected += sum * Spectrum{r[i], g[i], b[i]};
        products[i] = luminance(sum * Spectrum{r[i], g[i], b[i]});
    }
    on_every_target([&] {
        std::vector<float> found(cells);
        const Spectrum sum = sum_cells(radiance, lit, {r, g, b}, found);
        EXPECT_NEAR(sum.r, expected.r, 1e-4f * expected.r);
        EXPECT_NEAR(sum.g, expected.g, 1e-4f * expected.g);
        EXPECT_NEAR(sum.b, expected.b, 1e-4f * expected.b);
        EXPECT_EQ(sum, sum_cells(radiance, lit, {r, g, b}, {}));
        for (std::size_t i = 0; i < cells; ++i)
            ASSERT_NEAR(found[i], products[i], 1e-5f * products[i] + 1e-9f);
    });
}

TEST(CellSumKernel, FindsCurvedCellsOnEveryTarget) {
    constexpr std::size_t side = mask_side / 2, cells = side * side;
    std::vector<float> values(cells);
    CellMask wanted = all_cells;
    for (std::size_t y = 0; y < side; ++y) wanted[y] = y % 3 == 0 ? 0 : hash(y, 3) | 0xffffff;
    const auto is_wanted = [&](std::size_t i) { return (wanted[i / side] >> i % side & 1) != 0; };
    double sum = 0, count = 0;
    for (std::size_t i = 0; i < cells; ++i) {
        values[i] = 1 + uniform(i, 1, 0, hash(i, 2) % 16 == 0 ? 1 : 0.05f);
        if (is_wanted(i)) sum += values[i], ++count;
    }
    const double mean = sum / count;
    std::vector<std::uint32_t> expected;
    for (std::uint32_t i = 0; i < cells; ++i) {
        if (!is_wanted(i)) continue;
        if (i % side == 0 || i % side == side - 1 || i / side == 0 || i / side == side - 1) continue;
        const float bend = std::abs(values[i - 1] - 2 * values[i] + values[i + 1])
                           + std::abs(values[i - side] - 2 * values[i] + values[i + side]);
        if (bend > 0.3f * (values[i] + static_cast<float>(mean))) expected.push_back(i);
    }
    ASSERT_GT(expected.size(), 100u);
    ASSERT_LT(expected.size(), cells / 2);
    on_every_target([&] {
        std::vector<std::uint32_t> found;
        find_curved_cells(values, wanted, 0.3f, found);
        EXPECT_EQ(found, expected);
    });
}

TEST(CellSumKernel, ReflectsTilesOfBitsOnEveryTarget) {
    constexpr std::size_t side = mask_side / 4, tiles = side * side;
    std::vector<std::uint32_t> radiance(mask_bits);
    Mask lit;
    lit.fill({5, 57, 7, 128});
    lit.fill({100, 101, 30, 31});
    for (std::size_t i = 0; i < radiance.size(); ++i)
        if (i / 64 % 3 != 0) radiance[i] = pack_rgbe({uniform(i, 1, 0, 5), uniform(i, 2, 0, 1), 1});
    std::vector<float> x(tiles), y(tiles), z(tiles), r(tiles), g(tiles), b(tiles);
    for (std::size_t i = 0; i < tiles; ++i) {
        const Vec3 w = random_direction(i, 3);
        x[i] = w.x, y[i] = w.y, z[i] = std::abs(w.z);
    }
    ReceiverBsdf bsdf;
    bsdf.diffuse = {0.5f, 0.3f, 0.1f};
    bsdf.specular_f0 = {0.9f, 0.6f, 0.3f};
    bsdf.specular_f90 = Spectrum{1};
    bsdf.specular = true;
    bsdf.ggx.alpha = 0.4f;
    bsdf.w_out = {normalize({0.5f, 0.2f, 0.6f})};
    bsdf.shading_x = {1, 0, 0};
    bsdf.shading_y = {0, 1, 0};
    bsdf.shading_z = {0, 0, 1};
    on_every_target([&] {
        evaluate(bsdf, {x, y, z}, {r, g, b});
        Spectrum expected;
        for (int row = 0; row < mask_side; ++row)
            for (int column = 0; column < mask_side; ++column) {
                if (!lit.test(column, row)) continue;
                const auto tile =
                    static_cast<std::size_t>(row / 4) * side + static_cast<std::size_t>(column / 4);
                expected += unpack_rgbe(radiance[static_cast<std::size_t>(row * mask_side + column)])
                            * Spectrum{r[tile], g[tile], b[tile]};
            }
        const Spectrum found = reflect_tiles(bsdf, {x, y, z}, radiance, lit);
        EXPECT_GT(expected.g, 1);
        EXPECT_NEAR(found.r, expected.r, 1e-4f * expected.r);
        EXPECT_NEAR(found.g, expected.g, 1e-4f * expected.g);
        EXPECT_NEAR(found.b, expected.b, 1e-4f * expected.b);
    });
}

}  // namespace
}  // namespace relumine
