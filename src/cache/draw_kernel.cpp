// SPDX-License-Identifier: Apache-2.0
// The drawing kernel.
#include "cache/draw_kernel.hpp"

#include <algorithm>
#include <bit>
#include <cstring>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "cache/draw_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace relumine::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using U = hn::CappedTag<std::uint32_t, surfel_padding>;
using VU = hn::Vec<U>;

/// Whether a row of a surfel's texels fits into one vector, from where it is stretched by a table look-up.
constexpr bool row_fits = hn::MaxLanes(U()) >= max_surfel_side;

/// A row of bits in one register. Rows are always read and written whole: what one surfel has written is then
/// forwarded to the next, which a load wider than the store, or across two of them, would have to wait for.
struct RowBits {
#if HWY_TARGET == HWY_SCALAR
    MaskRow v;
    static HWY_INLINE RowBits load(const MaskRow& row) { return {row}; }
    HWY_INLINE void store(MaskRow& row) const { row = v; }
    HWY_INLINE RowBits operator&(RowBits b) const { return {v & b.v}; }
    HWY_INLINE RowBits operator|(RowBits b) const { return {v | b.v}; }
    HWY_INLINE RowBits without(RowBits b) const { return {v & ~b.v}; }
    [[nodiscard]] HWY_INLINE bool any() const { return v.any(); }
#else
    using R = hn::FixedTag<std::uint64_t, 2>;
    hn::Vec<R> v;
    static HWY_INLINE RowBits load(const MaskRow& row) { return {hn::LoadU(R(), &row.low)}; }
    HWY_INLINE void store(MaskRow& row) const { hn::StoreU(v, R(), &row.low); }
    HWY_INLINE RowBits operator&(RowBits b) const { return {hn::And(v, b.v)}; }
    HWY_INLINE RowBits operator|(RowBits b) const { return {hn::Or(v, b.v)}; }
    HWY_INLINE RowBits without(RowBits b) const { return {hn::AndNot(b.v, v)}; }
    [[nodiscard]] HWY_INLINE bool any() const { return !hn::AllTrue(R(), hn::Eq(v, hn::Zero(R()))); }
#endif
};

/// So many columns of a rectangle are drawn at a time.
constexpr std::uint32_t widest = 32;

/// Columns [x0, x0 + width) of the rows of the open bits.
struct OpenColumns {
    RowBits span;
    std::size_t byte;     // of the row, from where eight hold the columns
    std::uint32_t shift;  // of column x0 therein
    std::uint64_t columns;

    HWY_INLINE OpenColumns(std::uint32_t x0, std::uint32_t width)
        : span(RowBits::load(bit_span(static_cast<int>(x0), static_cast<int>(x0 + width)))),
          byte(std::min(x0 / 8, 8u)),
          shift(x0 - 8 * static_cast<std::uint32_t>(byte)),
          columns((std::uint64_t{1} << width) - 1) {}

    /// Takes what is open of a row; bit 0 of it is column x0.
    HWY_INLINE std::uint64_t take(MaskRow& open) const {
        std::uint64_t bits;
        std::memcpy(&bits, reinterpret_cast<const char*>(&open) + byte, sizeof bits);
        RowBits::load(open).without(span).store(open);
        return bits >> shift & columns;
    }
};
static_assert(std::endian::native == std::endian::little);

/// The lanes from `first` on of a surfel's row, stretched to its rectangle's width.
HWY_INLINE VU stretched(const std::uint32_t* texels, const TexelSteps& steps, std::uint32_t first) {
    const U u;
    if constexpr (row_fits) {
        const VU bit = hn::Add(hn::Iota(u, 0), hn::Set(u, first));
        const VU step = hn::Set(u, steps.step());
        const VU texel = hn::ShiftRight<16>(hn::Add(hn::Mul(bit, step), hn::ShiftRight<1>(step)));
        const VU inside = hn::Min(texel, hn::Set(u, max_surfel_side - 1));  // lanes past the rectangle
        return hn::TableLookupLanes(hn::LoadU(u, texels), hn::IndicesFromVec(u, inside));
    } else {
        HWY_ALIGN std::uint32_t lanes[surfel_padding];
        for (std::uint32_t i = 0; i < hn::Lanes(u); ++i)
            lanes[i] = texels[std::min(steps(first + i), max_surfel_side - 1)];
        return hn::Load(u, lanes);
    }
}

HWY_INLINE void store_under_mask(VU values, std::uint64_t bits, std::uint32_t* out) {
    const U u;
    hn::BlendedStore(values, hn::LoadMaskBits(u, reinterpret_cast<const std::uint8_t*>(&bits)), u, out);
}

/// The part of a surfel's drawing that is the same for all its rows.
struct Brush {
    BitRect rect;
    TexelSteps columns, rows;
    const std::uint32_t* texels;  // the surfel's first
    std::size_t side;             // texels from one row to the next

    HWY_INLINE Brush(const BitRect& r, const TexelRect& part, std::span<const std::uint32_t> texture,
                     std::size_t texture_side)
        : rect(r),
          columns(part.width, static_cast<std::uint32_t>(r.width())),
          rows(part.height, static_cast<std::uint32_t>(r.height())),
          texels(&texture[part.v * texture_side + part.u]),
          side(texture_side) {}

    /// Writes the columns [begin, end) of the rectangle's row y where `fresh` is set; bit 0 of it is column
    /// `begin`.
    HWY_INLINE void write(std::uint32_t y, std::uint32_t begin, std::uint32_t end, std::uint64_t fresh,
                          std::uint32_t* canvas) const {
        const std::uint32_t* row = texels + rows(y) * side;
        std::uint32_t* out = canvas + (rect.y0 + y) * mask_side + rect.x0;
        for (std::uint32_t x = begin; x < end; x += static_cast<std::uint32_t>(hn::Lanes(U())))
            store_under_mask(stretched(row, columns, x), fresh >> (x - begin), out + x);
    }
};

/// Single texels are the most frequent surfels: one colour over a few bits.
constexpr std::uint32_t dot_width = 4;

HWY_INLINE void dot_row(std::uint32_t color, std::uint64_t fresh, std::uint32_t* out) {
    const hn::CappedTag<std::uint32_t, dot_width> d;
    for (std::size_t x = 0; x < dot_width; x += hn::Lanes(d)) {
        const std::uint64_t bits = fresh >> x;
        const auto mask = hn::LoadMaskBits(d, reinterpret_cast<const std::uint8_t*>(&bits));
        hn::StoreU(hn::IfThenElse(mask, hn::Set(d, color), hn::LoadU(d, out + x)), d, out + x);
    }
}

/// Black texels: the canvas is black where nothing has been drawn.
/// `drawn`: bits are added to it, any row's.
HWY_INLINE void draw_black(const BitRect& rect, Mask& open, RowBits& drawn) {
    const RowBits span = RowBits::load(bit_span(rect.x0, rect.x1));
    const std::size_t y1 = rect.y1;
    for (std::size_t y = rect.y0; y < y1; ++y) {
        const RowBits row = RowBits::load(open.rows[y]);
        row.without(span).store(open.rows[y]);
        drawn = drawn | (row & span);
    }
}

template <bool with_direct>
HWY_INLINE bool draw_dot(const Brush& brush, const Brush& direct, const Canvas& canvas) {
    const BitRect& rect = brush.rect;
    const std::uint32_t color = brush.texels[0], direct_color = direct.texels[0];
    const OpenColumns columns(rect.x0, static_cast<std::uint32_t>(rect.width()));
    std::uint64_t any = 0;
    for (std::size_t y = rect.y0; y < rect.y1; ++y) {
        const std::uint64_t fresh = columns.take(canvas.open.rows[y]);
        if (fresh == 0) continue;
        any |= fresh;
        dot_row(color, fresh, &canvas.radiance[y * mask_side + rect.x0]);
        if constexpr (with_direct) dot_row(direct_color, fresh, &canvas.direct[y * mask_side + rect.x0]);
    }
    return any != 0;
}

/// Surfels whose rectangle's rows fit into one vector: a row of texels is stretched once for all rows that
/// show it.
template <bool with_direct>
HWY_INLINE bool draw_narrow(const Brush& brush, const Brush& direct, const Canvas& canvas) {
    const BitRect& rect = brush.rect;
    const auto width = static_cast<std::uint32_t>(rect.width());
    const OpenColumns columns(rect.x0, width);
    std::uint32_t* const out = &canvas.radiance[rect.y0 * mask_side + rect.x0];
    VU row = hn::Zero(U());
    std::uint64_t any = 0;
    std::uint32_t row_number = ~0u;
    for (std::uint32_t y = 0; y < static_cast<std::uint32_t>(rect.height()); ++y) {
        const std::uint64_t fresh = columns.take(canvas.open.rows[rect.y0 + y]);
        if (fresh == 0) continue;
        any |= fresh;
        if (const std::uint32_t wanted = brush.rows(y); wanted != row_number) {
            row_number = wanted;
            row = stretched(brush.texels + wanted * brush.side, brush.columns, 0);
        }
        store_under_mask(row, fresh, out + y * mask_side);
        if constexpr (with_direct) direct.write(y, 0, width, fresh, canvas.direct.data());
    }
    return any != 0;
}

template <bool with_direct>
bool draw_wide(const Brush& brush, const Brush& direct, const Canvas& canvas) {
    const BitRect& rect = brush.rect;
    std::uint64_t any = 0;
    for (std::uint32_t x = rect.x0; x < rect.x1; x += widest) {
        const std::uint32_t begin = x - rect.x0, width = std::min(widest, rect.x1 - x);
        const OpenColumns columns(x, width);
        for (std::uint32_t y = 0; y < static_cast<std::uint32_t>(rect.height()); ++y) {
            const std::uint64_t fresh = columns.take(canvas.open.rows[rect.y0 + y]);
            if (fresh == 0) continue;
            any |= fresh;
            brush.write(y, begin, begin + width, fresh, canvas.radiance.data());
            if constexpr (with_direct) direct.write(y, begin, begin + width, fresh, canvas.direct.data());
        }
    }
    return any != 0;
}

/// One surfel; whether any of its bits were open.
template <bool with_direct>
HWY_INLINE bool draw(const BitRect& mask, const TexelRect& texels, const RecordTexture& texture,
                     const Canvas& canvas) {
    const Brush brush(mask, texels, texture.radiance, texture.side);
    const Brush direct = with_direct ? Brush(mask, texels, texture.direct, texture.side) : brush;
    const auto width = static_cast<std::uint32_t>(mask.width());
    if (width <= dot_width && texels.width == 1 && texels.height == 1)
        return draw_dot<with_direct>(brush, direct, canvas);
    return width <= hn::Lanes(U()) ? draw_narrow<with_direct>(brush, direct, canvas)
                                   : draw_wide<with_direct>(brush, direct, canvas);
}

template <bool with_direct>
bool draw_each(std::span<const BitRect> masks, const DrawnSurfels& surfels, const RecordTexture& texture,
               const Canvas& canvas) {
    bool any = false;
    RowBits black = RowBits::load({});
    for (std::size_t i = 0; i < masks.size(); ++i) {
        if (masks[i].empty()) continue;
        if (surfels.black[i] != 0)
            draw_black(masks[i], canvas.open, black);
        else
            any |= draw<with_direct>(masks[i], surfels.texels[i], texture, canvas);
    }
    return any || black.any();
}

bool draw_all(std::span<const BitRect> masks, const DrawnSurfels& surfels, const RecordTexture& texture,
              const Canvas& canvas) {
    return canvas.direct.empty() ? draw_each<false>(masks, surfels, texture, canvas)
                                 : draw_each<true>(masks, surfels, texture, canvas);
}

/// Trails are many and long: only their union touches the other masks.
void close_all(std::span<const BitRect> trails, std::span<const BitRect> masks, Mask& open, Mask& unknown) {
    Mask closed;
    std::uint32_t first = mask_side, last = 0;
    for (std::size_t i = 0; i < trails.size(); ++i) {
        const BitRect trail = trails[i];
        if (trail.empty() || trail == masks[i]) continue;
        first = std::min<std::uint32_t>(first, trail.y0);
        last = std::max<std::uint32_t>(last, trail.y1);
        const RowBits span = RowBits::load(bit_span(trail.x0, trail.x1));
        for (std::size_t y = trail.y0; y < trail.y1; ++y)
            (RowBits::load(closed.rows[y]) | span).store(closed.rows[y]);
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
HWY_EXPORT(close_all);

bool draw_surfels(std::span<const BitRect> masks, const DrawnSurfels& surfels, const RecordTexture& texture,
                  const Canvas& canvas) {
    return HWY_DYNAMIC_DISPATCH(draw_all)(masks, surfels, texture, canvas);
}

void close_trails(std::span<const BitRect> trails, std::span<const BitRect> masks, Mask& open,
                  Mask& unknown) {
    HWY_DYNAMIC_DISPATCH(close_all)(trails, masks, open, unknown);
}

}  // namespace relumine
#endif
