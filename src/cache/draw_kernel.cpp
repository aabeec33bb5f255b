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

/// Most rectangles are narrow: the bits of a row that they touch fit into 32, read and written together.
constexpr std::uint32_t narrow = 16;

/// Whether a row of a surfel's texels fits into one vector, from where it is stretched by a table look-up.
constexpr bool row_fits = hn::MaxLanes(U()) >= max_surfel_side;

/// A window of 32 bits of each row that holds bits x0 … x0 + narrow − 1.
struct Window {
    std::size_t byte;     // of the row
    std::uint32_t shift;  // of bit x0 within the window

    explicit HWY_INLINE Window(std::uint32_t x0)
        : byte(std::min(x0 / 8, 12u)), shift(x0 - 8 * static_cast<std::uint32_t>(byte)) {}
    HWY_INLINE std::uint32_t load(const MaskRow* row) const {
        std::uint32_t bits;
        std::memcpy(&bits, reinterpret_cast<const char*>(row) + byte, sizeof bits);
        return bits;
    }
    HWY_INLINE void store(MaskRow* row, std::uint32_t bits) const {
        std::memcpy(reinterpret_cast<char*>(row) + byte, &bits, sizeof bits);
    }
};
static_assert(std::endian::native == std::endian::little);

/// The rows of a narrow rectangle's masks.
struct NarrowRows {
    std::uint32_t count;
    Window window;
    std::uint32_t span;  // within the window
    MaskRow *open, *covered;

    HWY_INLINE NarrowRows(const BitRect& rect, const Canvas& canvas)
        : count(static_cast<std::uint32_t>(rect.height())),
          window(rect.x0),
          span(((1u << rect.width()) - 1) << window.shift),
          open(&canvas.open.rows[rect.y0]),
          covered(&canvas.covered.rows[rect.y0]) {}

    /// Takes what is open of row y, now covered; bit 0 is the rectangle's first column.
    HWY_INLINE std::uint32_t take(std::uint32_t y) const {
        const std::uint32_t bits = window.load(open + y), fresh = bits & span;
        if (fresh == 0) return 0;
        window.store(open + y, bits & ~span);
        window.store(covered + y, window.load(covered + y) | fresh);
        return fresh >> window.shift;
    }
};

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

/// Single texels are the most frequent surfels: one colour over a few bits. Without a way of their own a
/// whole reprojection takes 5 % longer.
constexpr std::uint32_t dot_width = 4;

HWY_INLINE void dot_row(std::uint32_t color, std::uint64_t fresh, std::uint32_t* out) {
    const hn::CappedTag<std::uint32_t, dot_width> d;
    for (std::size_t x = 0; x < dot_width; x += hn::Lanes(d)) {
        const std::uint64_t bits = fresh >> x;
        const auto mask = hn::LoadMaskBits(d, reinterpret_cast<const std::uint8_t*>(&bits));
        hn::StoreU(hn::IfThenElse(mask, hn::Set(d, color), hn::LoadU(d, out + x)), d, out + x);
    }
}

template <bool with_direct>
HWY_INLINE bool draw_dot(const Brush& brush, const Brush& direct, const Canvas& canvas) {
    const NarrowRows rows(brush.rect, canvas);
    const std::uint32_t color = brush.texels[0], direct_color = direct.texels[0];
    const std::size_t at = std::size_t{brush.rect.y0} * mask_side + brush.rect.x0;
    std::uint32_t* const radiance = canvas.radiance.data() + at;
    std::uint32_t* const direct_radiance = canvas.direct.data() + at;
    std::uint32_t any = 0;
    for (std::uint32_t y = 0; y < rows.count; ++y) {
        const std::uint32_t fresh = rows.take(y);
        if (fresh == 0) continue;
        any |= fresh;
        dot_row(color, fresh, radiance + y * mask_side);
        if constexpr (with_direct) dot_row(direct_color, fresh, direct_radiance + y * mask_side);
    }
    return any != 0;
}

template <bool with_direct>
HWY_INLINE bool draw_narrow(const Brush& brush, const Brush& direct, const Canvas& canvas) {
    const NarrowRows rows(brush.rect, canvas);
    const auto width = static_cast<std::uint32_t>(brush.rect.width());
    std::uint32_t* const radiance = canvas.radiance.data();
    const bool one_vector = width <= hn::Lanes(U());
    VU row = hn::Zero(U());  // where one vector holds it: the texture's row, kept while it stays the same
    std::uint32_t any = 0, row_number = ~0u;
    for (std::uint32_t y = 0; y < rows.count; ++y) {
        const std::uint32_t fresh = rows.take(y);
        if (fresh == 0) continue;
        any |= fresh;
        if (one_vector) {
            if (const std::uint32_t wanted = brush.rows(y); wanted != row_number) {
                row_number = wanted;
                row = stretched(brush.texels + wanted * brush.side, brush.columns, 0);
            }
            store_under_mask(row, fresh, radiance + (brush.rect.y0 + y) * mask_side + brush.rect.x0);
        } else {
            brush.write(y, 0, width, fresh, radiance);
        }
        if constexpr (with_direct) direct.write(y, 0, width, fresh, canvas.direct.data());
    }
    return any != 0;
}

template <bool with_direct>
bool draw_wide(const Brush& brush, const Brush& direct, const Canvas& canvas) {
    const BitRect& rect = brush.rect;
    const MaskRow span = bit_span(rect.x0, rect.x1);
    bool any = false;
    for (std::uint32_t y = rect.y0; y < rect.y1; ++y) {
        MaskRow& open = canvas.open.rows[y];
        const MaskRow fresh = open & span;
        if (!fresh.any()) continue;
        any = true;
        open = open & ~span;
        canvas.covered.rows[y] = canvas.covered.rows[y] | fresh;
        for (std::uint32_t x = rect.x0; x < rect.x1; x += narrow) {
            const std::uint32_t begin = x - rect.x0, width = std::min(narrow, rect.x1 - x);
            const std::uint32_t bits = fresh.bits(static_cast<int>(x), static_cast<int>(width));
            brush.write(y - rect.y0, begin, begin + width, bits, canvas.radiance.data());
            if constexpr (with_direct)
                direct.write(y - rect.y0, begin, begin + width, bits, canvas.direct.data());
        }
    }
    return any;
}

template <bool with_direct>
bool draw_each(std::span<const BitRect> masks, std::span<const TexelRect> texels,
               const RecordTexture& texture, const Canvas& canvas) {
    bool any = false;
    for (std::size_t i = 0; i < masks.size(); ++i) {
        if (masks[i].empty()) continue;
        const Brush brush(masks[i], texels[i], texture.radiance, texture.side);
        const Brush direct = with_direct ? Brush(masks[i], texels[i], texture.direct, texture.side) : brush;
        if (masks[i].width() <= static_cast<int>(dot_width) && texels[i].width == 1 && texels[i].height == 1)
            any |= draw_dot<with_direct>(brush, direct, canvas);
        else
            any |= masks[i].width() <= static_cast<int>(narrow)
                       ? draw_narrow<with_direct>(brush, direct, canvas)
                       : draw_wide<with_direct>(brush, direct, canvas);
    }
    return any;
}

bool draw_all(std::span<const BitRect> masks, std::span<const TexelRect> texels, const RecordTexture& texture,
              const Canvas& canvas) {
    return canvas.direct.empty() ? draw_each<false>(masks, texels, texture, canvas)
                                 : draw_each<true>(masks, texels, texture, canvas);
}

}  // namespace
}  // namespace relumine::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace relumine {

HWY_EXPORT(draw_all);

bool draw_surfels(std::span<const BitRect> masks, std::span<const TexelRect> texels,
                  const RecordTexture& texture, const Canvas& canvas) {
    return HWY_DYNAMIC_DISPATCH(draw_all)(masks, texels, texture, canvas);
}

}  // namespace relumine
#endif
