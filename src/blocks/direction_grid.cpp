// SPDX-License-Identifier: Apache-2.0
// Tabulating the grid's directions.
#include "blocks/direction_grid.hpp"

#include "base/assert.hpp"

namespace relumine {
namespace {

/// Bits 0, 2, 4 … of a Morton index, together.
constexpr std::uint32_t every_second_bit(std::uint32_t m) {
    m &= 0x55555555u;
    m = (m ^ (m >> 1)) & 0x33333333u;
    m = (m ^ (m >> 2)) & 0x0f0f0f0fu;
    m = (m ^ (m >> 4)) & 0x00ff00ffu;
    return (m ^ (m >> 8)) & 0x0000ffffu;
}

/// The inverse.
constexpr std::uint32_t spread_bits(std::uint32_t x) {
    x = (x ^ (x << 8)) & 0x00ff00ffu;
    x = (x ^ (x << 4)) & 0x0f0f0f0fu;
    x = (x ^ (x << 2)) & 0x33333333u;
    return (x ^ (x << 1)) & 0x55555555u;
}
static_assert(every_second_bit(spread_bits(93) | spread_bits(71) << 1) == 93);

}  // namespace

DirectionGrid::DirectionGrid(int texels_along_side)
    : side(texels_along_side),
      texels(static_cast<std::size_t>(side) * static_cast<std::size_t>(side)),
      tiles(texels / tile_texels),
      texel_solid_angle(sphere_solid_angle / static_cast<float>(texels)) {
    RELUMINE_ASSERT(side >= 16 && (side & (side - 1)) == 0);
    for (std::uint32_t texel = 0; texel < texels; ++texel) {
        const Vec3 d = direction_in(texel, {0.5f, 0.5f}).v;
        x.push_back(d.x);
        y.push_back(d.y);
        z.push_back(d.z);
        const std::uint32_t column = every_second_bit(texel), row = every_second_bit(texel >> 1);
        const auto last = static_cast<std::uint32_t>(side) - 1;
        right.push_back(spread_bits(std::min(column + 1, last)) | spread_bits(row) << 1);
        below.push_back(spread_bits(column) | spread_bits(std::min(row + 1, last)) << 1);
    }
    for (std::uint32_t tile = 0; tile < tiles; ++tile) {
        const std::uint32_t first = tile * static_cast<std::uint32_t>(tile_texels);
        Vec3 sum;
        for (std::uint32_t i = 0; i < tile_texels; ++i) sum += texel_center(first + i).v;
        const Vec3 center = normalize(sum);
        float cosine = 1;
        for (std::uint32_t i = 0; i < tile_texels; ++i)
            for (const Point2 corner : {Point2{0, 0}, {1, 0}, {0, 1}, {1, 1}})
                cosine = std::min(cosine, dot(center, direction_in(first + i, corner).v));
        tile_length.push_back(length(sum) / tile_texels);
        tile_x.push_back(center.x);
        tile_y.push_back(center.y);
        tile_z.push_back(center.z);
        tile_sine.push_back(std::sqrt(std::max(0.0f, 1 - sqr(cosine))));
    }
}

WorldDir DirectionGrid::direction_in(std::uint32_t texel, Point2 inside) const {
    const auto along = [&](std::uint32_t index, float offset) {
        return (static_cast<float>(index) + offset) / static_cast<float>(side);
    };
    return square_to_sphere(
        {along(every_second_bit(texel), inside.x), along(every_second_bit(texel >> 1), inside.y)});
}

std::uint32_t DirectionGrid::texel_at(WorldDir direction) const {
    const Point2 p = sphere_to_square(direction);
    const auto index = [&](float along) {
        return static_cast<std::uint32_t>(
            std::clamp(static_cast<int>(along * static_cast<float>(side)), 0, side - 1));
    };
    return spread_bits(index(p.x)) | spread_bits(index(p.y)) << 1;
}

}  // namespace relumine
