// SPDX-License-Identifier: Apache-2.0
// What a receiver reflects of the radiance over its square: texture × BSDF × cosine, summed [V, §3.3].
#pragma once

#include "cache/receiver_bsdf.hpp"
#include "cache/reproject.hpp"

namespace relumine {

/// The square in cells of 2 × 2 bits: where the BSDF varies little, it is evaluated once per cell.
inline constexpr int cell_side = mask_side / 2;  // cells along each side
inline constexpr std::size_t cell_count = std::size_t{cell_side} * cell_side;
inline constexpr float cell_solid_angle = 2 * pi / static_cast<float>(cell_count);
inline constexpr float bit_solid_angle = cell_solid_angle / 4;

/// f·|cos θ| over the square: by cells, and by bits where a lobe is narrow.
struct BsdfTable {
    std::vector<float> r, g, b;             // cell_count each, 1/sr; 0 in fine cells
    std::vector<std::uint32_t> fine_cells;  // ascending
    std::vector<Spectrum> fine_bits;        // 4 per fine cell: bits (0,0), (1,0), (0,1), (1,1)

    std::vector<float> scratch;
};

/// For some cells, such as those that are lit; what the table has of others means nothing.
void tabulate(const ReceiverBsdf& bsdf, const CellMask& cells, BsdfTable& table);

struct ReflectedRadiance {
    Spectrum total, direct;
};

/// Σ L·f·|cos θ|·dω over the bits. Where `products` is not empty (cell_count), it receives every cell's share
/// of the luminance of `total`.
[[nodiscard]] ReflectedRadiance shade(const Reprojection& incident, const BsdfTable& table,
                                      std::span<float> products = {});

/// The same where a table would serve once: of lit cells alone, and where the lobe is wide and no products
/// are wanted without one, by tiles of 2 × 2 cells. `scratch` is overwritten.
[[nodiscard]] ReflectedRadiance shade(const Reprojection& incident, const ReceiverBsdf& bsdf,
                                      BsdfTable& scratch, std::span<float> products = {});

}  // namespace relumine
