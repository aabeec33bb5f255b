// SPDX-License-Identifier: Apache-2.0
// The drawing kernel.
#include "cache/draw_kernel.hpp"

#include <algorithm>
#include <bit>
#include <type_traits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "cache/draw_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "cache/cells-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace relumine::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using U = hn::CappedTag<std::uint32_t, surfel_padding>;
using VU = hn::Vec<U>;
using I = hn::Rebind<std::int32_t, U>;

/// Rows of bits are changed in windows of eight, read and written at multiples of a vector: what one surfel
/// has written is then forwarded to the next, which a load across two stores would have to wait for. Most
/// surfels fit into one window; a loop whose count is guessed wrongly costs more than rows that change
/// nothing.
constexpr std::uint32_t window_rows = 8;
using R = hn::CappedTag<std::uint64_t, 8>;
using VR = hn::Vec<R>;

/// So many rows of ones between rows of zeros: from where a window is read decides which of its rows are
/// ones.
struct alignas(64) RowsOfOnes {
    std::array<std::array<MaskRow, 2 * window_rows>, window_rows + 1> number{};
    constexpr RowsOfOnes() {
        for (std::size_t n = 0; n <= window_rows; ++n)
            for (std::size_t i = 0; i < n; ++i) number[n][window_rows + i] = ~MaskRow{};
    }
};
constexpr RowsOfOnes rows_of_ones;

HWY_INLINE VR repeated(const MaskRow& row, std::size_t word) {
#if HWY_TARGET == HWY_SCALAR
    return hn::Set(R(), word % 2 == 0 ? row.low : row.high);
#else
    (void)word;
    return hn::LoadDup128(R(), &row.low);
#endif
}

/// Calls change(words, bits) for all the mask's words that the rectangle touches; `bits` are the rectangle's.
template <typename Change>
HWY_INLINE void for_rows(const BitRect& rect, Mask& mask, const Change& change) {
    const MaskRow span = bit_span(rect.x0, rect.x1);
    std::uint32_t y = rect.y0;
    do {
        const std::uint32_t first = std::min(y & ~3u, mask_side - window_rows);
        const std::uint32_t before = y - first, count = std::min(rect.y1 - first, window_rows) - before;
        const std::uint64_t* ones = &rows_of_ones.number[count][window_rows - before].low;
        std::uint64_t* words = &mask.rows[first].low;
        for (std::size_t i = 0; i < 2 * window_rows; i += hn::Lanes(R()))
            change(words + i, hn::And(repeated(span, i), hn::LoadU(R(), ones + i)));
        y = first + window_rows;
    } while (y < rect.y1);
}

/// Takes the rectangles from the open bits; whether any was open.
bool take(std::span<const BitRect> rects, Mask& open) {
    VR taken = hn::Zero(R());
    for (const BitRect& rect : rects)
        for_rows(rect, open, [&](std::uint64_t* words, VR bits) {
            const VR before = hn::Load(R(), words);
            hn::Store(hn::AndNot(bits, before), R(), words);
            taken = hn::Or(taken, hn::And(before, bits));
        });
    return !hn::AllTrue(R(), hn::Eq(taken, hn::Zero(R())));
}

/// Whether a bit of the rectangle is open.
HWY_INLINE bool any_open(const BitRect& rect, Mask& open) {
    VR found = hn::Zero(R());
    for_rows(rect, open, [&](const std::uint64_t* words, VR bits) {
        found = hn::Or(found, hn::And(hn::Load(R(), words), bits));
    });
    return !hn::AllTrue(R(), hn::Eq(found, hn::Zero(R())));
}

/// Columns [begin, begin + Lanes) of the square, begin a multiple of the lanes: canvas and bits are then read
/// and written at multiples of a vector.
struct Block {
    std::uint32_t begin;

    [[nodiscard]] HWY_INLINE hn::Mask<U> of(const MaskRow& row) const { return cells::lanes_of(row, begin); }
    [[nodiscard]] HWY_INLINE VU columns() const { return hn::Add(hn::Iota(U(), 0), hn::Set(U(), begin)); }
};

/// Stretches rows of a surfel's texels over its rectangle.
struct Stretch {
    VU texel;
    hn::Mask<U> inside;  // lanes of the block that the rectangle has

    HWY_INLINE Stretch(const TexelSteps& steps, const BitRect& rect, const Block& block) {
        const U u;
        const VU bit = hn::Sub(block.columns(), hn::Set(u, rect.x0)), step = hn::Set(u, steps.step());
        inside = hn::RebindMask(u, hn::Lt(hn::BitCast(I(), bit), hn::Set(I(), rect.width())));
        inside = hn::And(inside, hn::RebindMask(u, hn::Gt(hn::BitCast(I(), bit), hn::Set(I(), -1))));
        const VU found = hn::ShiftRight<16>(hn::Add(hn::Mul(bit, step), hn::ShiftRight<1>(step)));
        texel = hn::Min(found, hn::Set(u, max_surfel_side - 1));  // of lanes that are not inside
    }

    HWY_INLINE VU operator()(const std::uint32_t* texels) const {
        if constexpr (hn::MaxLanes(U()) >= max_surfel_side)
            return hn::TableLookupLanes(hn::LoadU(U(), texels), hn::IndicesFromVec(U(), texel));
        else
            return hn::GatherIndex(U(), texels, hn::BitCast(I(), texel));
    }
};

/// Replaces some lanes of memory, `out` a multiple of a vector. Masked stores take tens of cycles on some
/// machines of 2020 to 2023; nobody else writes to the canvas.
HWY_INLINE void replace(hn::Mask<U> lanes, VU values, std::uint32_t* out) {
    hn::StoreU(hn::IfThenElse(lanes, values, hn::LoadU(U(), out)), U(), out);
}

/// A surfel's texels over its rectangle, where bits are open. `rect` and `part` are copies: bytes might be
/// any memory's, and would be read again after every store.
HWY_NOINLINE void paint(const BitRect rect, const TexelRect part, std::span<const std::uint32_t> texture,
                        std::size_t side, const Mask& open, std::span<std::uint32_t> canvas) {
    const auto lanes = static_cast<std::uint32_t>(hn::Lanes(U()));
    const TexelSteps across(part.width, static_cast<std::uint32_t>(rect.width())),
        down(part.height, static_cast<std::uint32_t>(rect.height()));
    const std::uint32_t* const texels = &texture[part.v * side + part.u];
    const std::size_t height = static_cast<std::size_t>(rect.height());
    for (Block block{rect.x0 / lanes * lanes}; block.begin < rect.x1; block.begin += lanes) {
        const Stretch stretch(across, rect, block);
        const MaskRow* row = &open.rows[rect.y0];
        std::uint32_t* out = &canvas[rect.y0 * std::size_t{mask_side} + block.begin];
        std::size_t texel = down.step() / 2;  // of TexelSteps
        for (std::size_t y = 0; y < height; ++y, texel += down.step(), ++row, out += mask_side)
            replace(hn::And(stretch.inside, block.of(*row)), stretch(texels + (texel >> 16) * side), out);
    }
}

/// From the last surfel to the first, so that the first stays on top while the open bits stay as they are:
/// no surfel waits for the one before.
void paint_all(std::span<const BitRect> masks, std::span<const TexelRect> texels,
               const RecordTexture& texture, const Canvas& canvas) {
    for (std::size_t i = masks.size(); i-- > 0;) {
        if (masks[i].empty()) continue;
        paint(masks[i], texels[i], texture.radiance, texture.side, canvas.open, canvas.radiance);
        if (!canvas.direct.empty())
            paint(masks[i], texels[i], texture.direct, texture.side, canvas.open, canvas.direct);
    }
}

/// Lanes as bits of a word.
HWY_INLINE std::uint64_t bits_of(hn::Mask<U> lanes) {
    std::uint64_t bits = 0;
    hn::StoreMaskBits(U(), lanes, reinterpret_cast<std::uint8_t*>(&bits));
    return bits;
}
HWY_INLINE hn::Mask<U> lanes_of_bits(std::uint64_t bits) {
    return hn::LoadMaskBits(U(), reinterpret_cast<const std::uint8_t*>(&bits));
}

/// For each row of a surfel's texels the bits of a block that show one that was missed, at the block's place
/// in its word.
struct MissedBits {
    std::array<std::uint64_t, max_surfel_side> of_row;

    HWY_INLINE MissedBits(const TexelRect& part, std::span<const std::uint8_t> missed, std::size_t side,
                          const Stretch& stretch, const Block& block) {
        const std::uint8_t* byte = &missed[(part.v * side + part.u) / 8];
        const VU bit_of_texel = hn::Shl(hn::Set(U(), 1), stretch.texel);
        for (std::size_t v = 0; v < part.height; ++v, byte += side / 8) {
            const VU from_first_column = hn::Set(U(), static_cast<std::uint32_t>(*byte >> part.u % 8));
            of_row[v] = bits_of(hn::And(stretch.inside, hn::TestBit(from_first_column, bit_of_texel)))
                        << block.begin % 64;
        }
    }
};

/// As paint, but for texels that were hit. `drawn`: bits are added to it.
template <bool with_direct>
HWY_NOINLINE void paint_missed(const BitRect rect, const TexelRect part, const RecordTexture& texture,
                               const Canvas& canvas, Mask& drawn) {
    const auto lanes = static_cast<std::uint32_t>(hn::Lanes(U()));
    const TexelSteps across(part.width, static_cast<std::uint32_t>(rect.width())),
        down(part.height, static_cast<std::uint32_t>(rect.height()));
    const std::size_t side = texture.side, first = part.v * side + part.u;
    const std::uint32_t *const texels = &texture.radiance[first], *const direct_texels =
                                                                      with_direct ? &texture.direct[first]
                                                                                  : nullptr;
    std::uint32_t *const radiance = canvas.radiance.data(), *const direct = canvas.direct.data();
    const std::size_t height = static_cast<std::size_t>(rect.height());
    for (Block block{rect.x0 / lanes * lanes}; block.begin < rect.x1; block.begin += lanes) {
        const Stretch stretch(across, rect, block);
        const MissedBits missed(part, texture.missed, side, stretch, block);
        const std::uint64_t* open_word = &canvas.open.rows[rect.y0].low + block.begin / 64;
        std::uint64_t* drawn_word = &drawn.rows[rect.y0].low + block.begin / 64;
        std::size_t at = rect.y0 * std::size_t{mask_side} + block.begin;
        std::size_t position = down.step() / 2;  // of TexelSteps
        for (std::size_t y = 0; y < height; ++y, position += down.step(), at += mask_side) {
            const std::size_t texel = position >> 16;
            const std::uint64_t fresh = missed.of_row[texel] & open_word[2 * y];
            if (fresh == 0) continue;  // hit, or hidden: so it is over long stretches
            const auto fresh_lanes = lanes_of_bits(fresh >> block.begin % 64);
            replace(fresh_lanes, stretch(texels + texel * side), radiance + at);
            if constexpr (with_direct)
                replace(fresh_lanes, stretch(direct_texels + texel * side), direct + at);
            drawn_word[2 * y] |= fresh;
        }
    }
}

bool draw_all_missed(std::span<const BitRect> masks, std::span<const TexelRect> texels,
                     const RecordTexture& texture, const Canvas& canvas) {
    Mask drawn;
    const auto paint_one = canvas.direct.empty() ? paint_missed<false> : paint_missed<true>;
    for (std::size_t i = masks.size(); i-- > 0;)
        if (!masks[i].empty() && any_open(masks[i], canvas.open))
            paint_one(masks[i], texels[i], texture, canvas, drawn);
    MaskRow any;
    for (std::size_t y = 0; y < mask_side; ++y) {
        any = any | drawn.rows[y];
        canvas.lit.rows[y] = canvas.lit.rows[y] | drawn.rows[y];
        canvas.open.rows[y] = canvas.open.rows[y] & ~drawn.rows[y];
    }
    return any.any();
}

bool draw_all(std::span<const BitRect> masks, const DrawnSurfels& surfels, const RecordTexture& texture,
              const Canvas& canvas) {
    if (surfels.colored == 0) return take(masks, canvas.open);
    paint_all(masks.first(surfels.colored), surfels.texels, texture, canvas);
    const Mask before = canvas.open;
    const bool any = take(masks.first(surfels.colored), canvas.open);
    for (std::size_t y = 0; y < mask_side; ++y)
        canvas.lit.rows[y] = canvas.lit.rows[y] | (before.rows[y] & ~canvas.open.rows[y]);
    return take(masks.subspan(surfels.colored), canvas.open) || any;
}

/// Trails are many and long: only their union touches the other masks.
void close_all(std::span<const BitRect> trails, Mask& closed, Mask& open, Mask& unknown) {
    std::uint32_t first = mask_side, last = 0;
    for (const BitRect& trail : trails) {
        first = std::min<std::uint32_t>(first, trail.y0);
        last = std::max<std::uint32_t>(last, trail.y1);
        for_rows(trail, closed, [](std::uint64_t* words, VR bits) {
            hn::Store(hn::Or(hn::Load(R(), words), bits), R(), words);
        });
    }
    for (std::size_t y = first; y < last; ++y) {
        unknown.rows[y] = unknown.rows[y] | (open.rows[y] & closed.rows[y]);
        open.rows[y] = open.rows[y] & ~closed.rows[y];
    }
}

}  // namespace
}  // namespace relumine::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace relumine {

HWY_EXPORT(draw_all);
HWY_EXPORT(draw_all_missed);
HWY_EXPORT(close_all);

bool draw_surfels(std::span<const BitRect> masks, const DrawnSurfels& surfels, const RecordTexture& texture,
                  const Canvas& canvas) {
    return HWY_DYNAMIC_DISPATCH(draw_all)(masks, surfels, texture, canvas);
}

bool draw_missed(std::span<const BitRect> masks, std::span<const TexelRect> texels,
                 const RecordTexture& texture, const Canvas& canvas) {
    return HWY_DYNAMIC_DISPATCH(draw_all_missed)(masks, texels, texture, canvas);
}

void close_trails(std::span<const BitRect> trails, Mask& closed, Mask& open, Mask& unknown) {
    HWY_DYNAMIC_DISPATCH(close_all)(trails, closed, open, unknown);
}

}  // namespace relumine
#endif
