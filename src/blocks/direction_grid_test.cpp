// SPDX-License-Identifier: Apache-2.0
// The grid of directions: its order, and what it tabulates.
#include "blocks/direction_grid.hpp"

#include <gtest/gtest.h>

#include <set>

#include "base/hash.hpp"

namespace relumine {
namespace {

float uniform(std::uint64_t i, std::uint64_t what) {
    return unit_float(static_cast<std::uint32_t>(hash(i, what)));
}

struct Place {
    int column, row;

    auto operator<=>(const Place&) const = default;
};

Place place_of(const DirectionGrid& grid, std::size_t texel) {
    const Point2 p = sphere_to_square(grid.texel_center(texel));
    return {static_cast<int>(p.x * static_cast<float>(grid.side)),
            static_cast<int>(p.y * static_cast<float>(grid.side))};
}

class Grids : public ::testing::TestWithParam<int> {
  protected:
    const DirectionGrid grid{GetParam()};
};
INSTANTIATE_TEST_SUITE_P(Sides, Grids, ::testing::Values(16, 64, 128));

TEST_P(Grids, HaveAsManyTexelsAsTheySay) {
    const auto side = static_cast<std::size_t>(GetParam());
    EXPECT_EQ(grid.texels, side * side);
    EXPECT_EQ(grid.tiles * tile_texels, grid.texels);
    EXPECT_NEAR(grid.texel_solid_angle * static_cast<float>(grid.texels), 4 * pi, 1e-4f);
    for (const auto* plane : {&grid.x, &grid.y, &grid.z}) EXPECT_EQ(plane->size(), grid.texels);
    for (std::size_t texel = 0; texel < grid.texels; ++texel)
        ASSERT_NEAR(length(grid.texel_center(texel).v), 1, 1e-6f);
}

TEST_P(Grids, HaveTilesOfFourByFourTexels) {
    std::set<Place> seen;
    for (std::size_t tile = 0; tile < grid.tiles; ++tile) {
        const Place first = place_of(grid, tile * tile_texels);
        ASSERT_EQ(first.column % 4, 0);
        ASSERT_EQ(first.row % 4, 0);
        for (std::size_t i = 0; i < tile_texels; ++i) {
            const Place p = place_of(grid, tile * tile_texels + i);
            ASSERT_EQ(p.column / 4, first.column / 4);
            ASSERT_EQ(p.row / 4, first.row / 4);
            seen.insert(p);
        }
    }
    EXPECT_EQ(seen.size(), grid.texels);
}

TEST_P(Grids, KeepChildrenTogether) {
    const DirectionGrid finer(2 * grid.side);
    for (std::size_t child = 0; child < finer.texels; ++child)
        ASSERT_EQ(grid.texel_at(finer.texel_center(child)), child / 4);
}

TEST_P(Grids, FindTheTexelOfADirection) {
    for (std::uint32_t texel = 0; texel < grid.texels; ++texel)
        for (std::uint64_t i = 0; i < 4; ++i) {
            const Point2 inside{0.02f + 0.96f * uniform(8 * texel + i, 1),
                                0.02f + 0.96f * uniform(8 * texel + i, 2)};
            ASSERT_EQ(grid.texel_at(grid.direction_in(texel, inside)), texel) << inside.x << " " << inside.y;
        }
    for (const Vec3 d : {Vec3{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}})
        EXPECT_LT(grid.texel_at({d}), grid.texels);
}

TEST_P(Grids, BoundTheirTilesTightly) {
    for (std::uint32_t tile = 0; tile < grid.tiles; ++tile) {
        const Vec3 center = grid.tile_center(tile).v;
        ASSERT_NEAR(length(center), 1, 1e-6f);
        float most = 0;
        Vec3 sum;
        for (std::uint32_t i = 0; i < tile_texels; ++i) {
            const std::uint32_t texel = tile * static_cast<std::uint32_t>(tile_texels) + i;
            sum += grid.texel_center(texel).v;
            for (int k = 0; k < 64; ++k) {
                const Vec3 d = grid.direction_in(texel, {static_cast<float>(k % 8) / 7,
                                                         static_cast<float>(k) / 8 / 7.875f})
                                   .v;
                most = std::max(most, length(cross(center, d)));
            }
        }
        ASSERT_LE(most, grid.tile_sine[tile] + 1e-4f);
        ASSERT_GT(most, 0.95f * grid.tile_sine[tile]);
        ASSERT_NEAR(length(sum) / tile_texels, grid.tile_length[tile], 1e-6f);
        ASSERT_LT(length(normalize(sum) - center), 1e-6f);
    }
}

TEST_P(Grids, KnowTheNeighbours) {
    for (std::uint32_t texel = 0; texel < grid.texels; ++texel) {
        const Place p = place_of(grid, texel), right = place_of(grid, grid.right[texel]),
                    below = place_of(grid, grid.below[texel]);
        ASSERT_EQ(right.column, std::min(p.column + 1, grid.side - 1));
        ASSERT_EQ(right.row, p.row);
        ASSERT_EQ(below.column, p.column);
        ASSERT_EQ(below.row, std::min(p.row + 1, grid.side - 1));
    }
}

}  // namespace
}  // namespace relumine
