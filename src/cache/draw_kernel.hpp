// SPDX-License-Identifier: Apache-2.0
// Drawing projected surfels: texture under an alpha mask, whole rows of bits at a time [V, §3.3–3.4].
#pragma once

#include <span>

#include "cache/mask.hpp"
#include "cache/record.hpp"

namespace relumine {

namespace detail {
inline constexpr auto reciprocals = [] {  // of 1 … mask_side in 16-bit fixed point, rounded down
    std::array<std::uint32_t, mask_side + 1> table{};
    for (std::uint32_t i = 1; i <= mask_side; ++i) table[i] = 65536 / i;
    return table;
}();
}  // namespace detail

/// A surfel's texture over the bits of its rectangle: bit i of `bits` shows texel ⌊(i + ½)·texels / bits⌋, in
/// 16-bit fixed point.
class TexelSteps {
  public:
    TexelSteps(std::uint32_t texels, std::uint32_t bits) : step_(texels * detail::reciprocals[bits]) {}
    [[nodiscard]] std::uint32_t operator()(std::uint32_t bit) const {
        return (bit * step_ + step_ / 2) >> 16;
    }
    [[nodiscard]] std::uint32_t step() const { return step_; }

  private:
    std::uint32_t step_;
};

/// What surfels are drawn into.
struct Canvas {
    SplitMask& open;                    // bits that may be drawn; those drawn are taken away
    SplitMask& lit;                     // bits drawn that may not be black are added
    std::span<std::uint32_t> radiance;  // mask_side², row-major in (y, x); black surfels leave it alone
    std::span<std::uint32_t> direct;    // the same, or empty
};

/// What they are drawn with.
struct RecordTexture {
    std::span<const std::uint32_t> radiance;  // side² (+ surfel_padding), row-major in (v, u)
    std::span<const std::uint32_t> direct;    // the same; used only where the canvas keeps it
    std::size_t side;
    std::span<const std::uint8_t> missed;  // side²/8, bit u % 8 of byte (v · side + u)/8: at infinity
};

/// Which surfels.
struct DrawnSurfels {
    std::span<const TexelRect> texels;
    std::size_t colored;  // so many come first; all texels of the others are black
};

/// Draws surfels where bits are open, the first on top; whether any bit was. `masks[i]` belongs to
/// surfel i; surfel_padding more than those given are read; the canvas's arrays must have room for
/// surfel_padding more elements past what is drawn.
bool draw_surfels(std::span<const BitRect> masks, const DrawnSurfels& surfels, const RecordTexture& texture,
                  const Canvas& canvas);

/// The same for surfels at infinity, whose texels are drawn only where they were missed. A surfel lies within
/// eight columns of texels from a multiple of eight on.
bool draw_missed(std::span<const BitRect> masks, std::span<const TexelRect> texels,
                 const RecordTexture& texture, const Canvas& canvas);

/// The same for a receiver that is not rotated, for whom the square at infinity is the record's.
bool copy_missed(const RecordTexture& texture, const Canvas& canvas);

/// Takes what lies in the trails of a layer, whose surfels have been drawn, from the open bits and adds it to
/// the unknown ones. `closed`: the trails of the layers before; those of this one are added. surfel_padding
/// more trails than those given are read.
void close_trails(std::span<const BitRect> trails, SplitMask& closed, SplitMask& open, SplitMask& unknown);

/// The bits that are not covered, by halves.
[[nodiscard]] SplitMask rest_of(const Mask& covered);

/// As SplitMask::joined.
void join(const SplitMask& mask, Mask& out);

}  // namespace relumine
