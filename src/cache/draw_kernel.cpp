// SPDX-License-Identifier: Apache-2.0
// The drawing kernel.
#include "cache/draw_kernel.hpp"

#include <algorithm>
#include <bit>
#include <cstring>
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

using R = hn::CappedTag<std::uint64_t, 8>;
using VR = hn::Vec<R>;

/// Lanes as bits of a word.
HWY_INLINE std::uint64_t bits_of(hn::Mask<U> lanes) {
    std::uint64_t bits = 0;
    hn::StoreMaskBits(U(), lanes, reinterpret_cast<std::uint8_t*>(&bits));
    return bits;
}
HWY_INLINE hn::Mask<U> lanes_of_bits(std::uint64_t bits) {
    return hn::LoadMaskBits(U(), reinterpret_cast<const std::uint8_t*>(&bits));
}

/// Rows of bits are changed in windows of one half of the mask, read and written at multiples of a vector:
/// what one surfel has written is then forwarded to the next, which a load across two stores would have to
/// wait for. Most surfels fit into one window; a loop whose count is guessed wrongly costs more than rows
/// that change nothing.
constexpr std::uint32_t window_rows = 16;
constexpr std::uint32_t window_step = hn::MaxLanes(R()) > 4 ? 8 : 4;  // windows begin at its multiples
constexpr std::uint32_t last_window = mask_side - window_rows;

/// So many rows of ones between rows of zeros: from where a window is read decides which of its rows are
/// ones.
constexpr std::uint32_t ones_stride = 2 * window_rows;
alignas(64) constexpr auto rows_of_ones = [] {
    std::array<std::uint64_t, (window_rows + 1) * ones_stride> rows{};
    for (std::size_t n = 0; n <= window_rows; ++n)
        for (std::size_t i = 0; i < n; ++i) rows[n * ones_stride + window_rows + i] = ~std::uint64_t{0};
    return rows;
}();

/// The bits below x of the columns 64 to 127, x in [0, 192].
constexpr auto bits_below_in_half = [] {
    std::array<std::uint64_t, 3 * 64 + 1> words{};
    for (std::size_t x = 64; x < words.size(); ++x)
        words[x] = x >= 128 ? ~std::uint64_t{0} : (std::uint64_t{1} << (x - 64)) - 1;
    return words;
}();

/// Calls change(words, bits) for the words of a window; `bits` are those of the rectangle it belongs to.
template <typename Change>
HWY_INLINE void for_words(VR columns, const std::uint64_t* ones, std::uint64_t* words, const Change& change) {
    for (std::size_t i = 0; i < window_rows; i += hn::Lanes(R()))
        change(words + i, hn::And(columns, hn::LoadU(R(), ones + i)));
}

HWY_INLINE VR columns_between(std::uint32_t from, std::uint32_t to) {
    return hn::AndNot(hn::Set(R(), bits_below_in_half[from]), hn::Set(R(), bits_below_in_half[to]));
}

/// The same for all windows that the rectangle touches.
template <typename Change>
HWY_INLINE void for_all_words(const BitRect rect, SplitMask& mask, const Change& change) {
    for (std::uint32_t half = rect.x0 / 64; 64 * half < rect.x1; ++half) {
        const VR columns = columns_between(rect.x0 + 64 - 64 * half, rect.x1 + 64 - 64 * half);
        std::uint32_t y = rect.y0;
        do {
            const std::uint32_t first = std::min(y & ~(window_step - 1), last_window), before = y - first;
            const std::uint32_t count = std::min(rect.y1 - first, window_rows) - before;
            for_words(columns, &rows_of_ones[count * ones_stride + window_rows - before],
                      &mask.halves[half][first], change);
            y = first + window_rows;
        } while (y < rect.y1);
    }
}

/// Rectangles in one window each. What windows need is worked out for as many rectangles at once as the
/// machine has lanes; the few that touch several windows are told apart.
class Windows {
  public:
    static constexpr std::size_t most = surfel_padding;

    /// `count` ≤ most; `most` are read.
    HWY_INLINE Windows(const BitRect* rects, std::size_t count) : rects_(rects), count_(count) {
        for (std::size_t i = 0; i < most; i += hn::Lanes(U())) several_ |= put(rects + i, i) << i;
        several_ &= (std::uint64_t{1} << count) - 1;
    }

    /// Calls change(words, bits) for all words that the rectangles touch.
    template <typename Change>
    HWY_INLINE void for_each_word(SplitMask& mask, const Change& change) const {
        std::uint64_t* const words = mask.halves.front().data();
        for (std::size_t i = 0; i < count_; ++i)
            for_words(columns_between(from_[i], to_[i]), &rows_of_ones[ones_[i]], words + word_[i], change);
        for (std::uint64_t left = several_; left != 0; left &= left - 1)
            for_all_words(rects_[std::countr_zero(left)], mask, change);
    }

  private:
    /// The windows in which Lanes rectangles begin; which of these touch others.
    HWY_INLINE std::uint64_t put(const BitRect* rects, std::size_t at) {
        const U u;
        const VU packed = hn::LoadU(u, reinterpret_cast<const std::uint32_t*>(rects)), byte = hn::Set(u, 255);
        const VU x0 = hn::And(packed, byte), x1 = hn::And(hn::ShiftRight<8>(packed), byte),
                 y0 = hn::And(hn::ShiftRight<16>(packed), byte), y1 = hn::ShiftRight<24>(packed);
        const VU half = hn::Min(hn::ShiftRight<6>(x0), hn::Set(u, 1)), left = hn::ShiftLeft<6>(half);
        const VU first = hn::Min(hn::And(y0, hn::Set(u, ~(window_step - 1))), hn::Set(u, last_window));
        const VU rows = hn::Set(u, window_rows), before = hn::Sub(y0, first);
        const VU count = hn::Sub(hn::Min(hn::Sub(y1, first), rows), before);
        hn::StoreU(hn::Add(hn::ShiftLeft<7>(half), first), u, &word_[at]);
        hn::StoreU(hn::Add(hn::ShiftLeft<5>(count), hn::Sub(rows, before)), u, &ones_[at]);
        hn::StoreU(hn::Add(hn::Sub(x0, left), hn::Set(u, 64)), u, &from_[at]);
        hn::StoreU(hn::Add(hn::Sub(x1, left), hn::Set(u, 64)), u, &to_[at]);
        const auto beyond = [&](VU end, VU begin, std::uint32_t length) HWY_ATTR {
            return hn::Gt(hn::BitCast(I(), end), hn::BitCast(I(), hn::Add(begin, hn::Set(u, length))));
        };
        return bits_of(hn::RebindMask(u, hn::Or(beyond(x1, left, 64), beyond(y1, first, window_rows))));
    }

    const BitRect* rects_;
    std::size_t count_;
    std::uint64_t several_ = 0;                                // rectangles that touch more than one window
    std::array<std::uint32_t, most> word_, ones_, from_, to_;  // of columns and rows: places in the tables
};
static_assert(ones_stride == 1 << 5 && mask_side == 1 << 7);

/// Calls visit(windows) for all rectangles; surfel_padding more are read.
template <typename Visit>
HWY_INLINE void for_windows(std::span<const BitRect> rects, const Visit& visit) {
    for (std::size_t i = 0; i < rects.size(); i += Windows::most)
        visit(Windows(&rects[i], std::min(rects.size() - i, Windows::most)));
}

/// The rows [first, last) that some rectangles touch.
struct Rows {
    std::size_t first, last;

    explicit Rows(std::span<const BitRect> rects) {
        const U u;
        VU least = hn::Set(u, 255), most = hn::Zero(u);
        for (std::size_t i = 0; i < rects.size(); i += hn::Lanes(u)) {
            const VU packed = hn::LoadU(u, reinterpret_cast<const std::uint32_t*>(&rects[i]));
            least = hn::Min(least, hn::And(hn::ShiftRight<16>(packed), hn::Set(u, 255)));
            most = hn::Max(most, hn::ShiftRight<24>(packed));
        }
        first = hn::GetLane(hn::MinOfLanes(u, least));
        last = std::min<std::size_t>(hn::GetLane(hn::MaxOfLanes(u, most)), mask_side);
    }
};

HWY_INLINE bool any(VR bits) { return !hn::AllTrue(R(), hn::Eq(bits, hn::Zero(R()))); }

/// Takes the rectangles from the open bits; whether any was open. Once one was nobody asks again.
bool take(std::span<const BitRect> rects, SplitMask& open) {
    bool found = false;
    for_windows(rects, [&](const Windows& windows) HWY_ATTR {
        if (found) {
            windows.for_each_word(open, [](std::uint64_t* words, VR bits) HWY_ATTR {
                hn::Store(hn::AndNot(bits, hn::Load(R(), words)), R(), words);
            });
            return;
        }
        VR taken = hn::Zero(R());
        windows.for_each_word(open, [&](std::uint64_t* words, VR bits) HWY_ATTR {
            const VR before = hn::Load(R(), words);
            hn::Store(hn::AndNot(bits, before), R(), words);
            taken = hn::Or(taken, hn::And(before, bits));
        });
        found = any(taken);
    });
    return found;
}

/// Whether a bit of the rectangle is open.
HWY_INLINE bool any_open(const BitRect& rect, SplitMask& open) {
    VR found = hn::Zero(R());
    for_all_words(rect, open, [&](const std::uint64_t* words, VR bits) HWY_ATTR {
        found = hn::Or(found, hn::And(hn::Load(R(), words), bits));
    });
    return any(found);
}

/// Columns [begin, begin + Lanes) of the square, begin a multiple of the lanes: canvas and bits are then read
/// and written at multiples of a vector.
struct Block {
    std::uint32_t begin;

    [[nodiscard]] HWY_INLINE std::size_t half() const { return begin / 64; }
    [[nodiscard]] HWY_INLINE std::size_t place() const { return begin % 64; }  // in words of its half
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
                        std::size_t side, const SplitMask& open, std::span<std::uint32_t> canvas) {
    const auto lanes = static_cast<std::uint32_t>(hn::Lanes(U()));
    const TexelSteps across(part.width, static_cast<std::uint32_t>(rect.width())),
        down(part.height, static_cast<std::uint32_t>(rect.height()));
    const std::uint32_t* const texels = &texture[part.v * side + part.u];
    const std::size_t height = static_cast<std::size_t>(rect.height());
    for (Block block{rect.x0 / lanes * lanes}; block.begin < rect.x1; block.begin += lanes) {
        const Stretch stretch(across, rect, block);
        const std::uint64_t* word = &open.halves[block.half()][rect.y0];
        std::uint32_t* out = &canvas[rect.y0 * std::size_t{mask_side} + block.begin];
        std::size_t texel = down.step() / 2;  // of TexelSteps
        for (std::size_t y = 0; y < height; ++y, texel += down.step(), ++word, out += mask_side)
            replace(hn::And(stretch.inside, cells::lanes_of(*word, block.place())),
                    stretch(texels + (texel >> 16) * side), out);
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
                        << block.place();
        }
    }
};

/// As paint, but for texels that were hit. `drawn`: bits are added to it.
template <bool with_direct>
HWY_NOINLINE void paint_missed(const BitRect rect, const TexelRect part, const RecordTexture& texture,
                               const Canvas& canvas, SplitMask& drawn) {
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
        const std::uint64_t* open_word = &canvas.open.halves[block.half()][rect.y0];
        std::uint64_t* drawn_word = &drawn.halves[block.half()][rect.y0];
        std::size_t at = rect.y0 * std::size_t{mask_side} + block.begin;
        std::size_t position = down.step() / 2;  // of TexelSteps
        for (std::size_t y = 0; y < height; ++y, position += down.step(), at += mask_side) {
            const std::size_t texel = position >> 16;
            const std::uint64_t fresh = missed.of_row[texel] & open_word[y];
            if (fresh == 0) continue;  // hit, or hidden: so it is over long stretches
            const auto fresh_lanes = lanes_of_bits(fresh >> block.place());
            replace(fresh_lanes, stretch(texels + texel * side), radiance + at);
            if constexpr (with_direct)
                replace(fresh_lanes, stretch(direct_texels + texel * side), direct + at);
            drawn_word[y] |= fresh;
        }
    }
}

bool draw_all_missed(std::span<const BitRect> masks, std::span<const TexelRect> texels,
                     const RecordTexture& texture, const Canvas& canvas) {
    SplitMask drawn;
    const auto paint_one = canvas.direct.empty() ? paint_missed<false> : paint_missed<true>;
    for (std::size_t i = masks.size(); i-- > 0;)
        if (!masks[i].empty() && any_open(masks[i], canvas.open))
            paint_one(masks[i], texels[i], texture, canvas, drawn);
    std::uint64_t any = 0;
    for (std::size_t half = 0; half < 2; ++half)
        for (std::size_t y = 0; y < mask_side; ++y) {
            any |= drawn.halves[half][y];
            canvas.lit.halves[half][y] |= drawn.halves[half][y];
            canvas.open.halves[half][y] &= ~drawn.halves[half][y];
        }
    return any != 0;
}

/// Each of 32 bits twice.
HWY_INLINE std::uint64_t doubled(std::uint64_t bits) {
    bits = (bits | bits << 16) & 0x0000ffff0000ffff;
    bits = (bits | bits << 8) & 0x00ff00ff00ff00ff;
    bits = (bits | bits << 4) & 0x0f0f0f0f0f0f0f0f;
    bits = (bits | bits << 2) & 0x3333333333333333;
    bits = (bits | bits << 1) & 0x5555555555555555;
    return bits | bits << 1;
}

/// A row of texels that were missed, by halves of the bits that show them; a texel shows in `scale` columns.
template <std::size_t scale>
HWY_INLINE std::array<std::uint64_t, 2> missed_halves(const std::uint8_t* missed, std::size_t v) {
    constexpr std::size_t bytes = mask_side / scale / 8;
    std::array<std::uint64_t, 2> halves{};
    std::memcpy(halves.data(), missed + v * bytes, bytes);
    for (std::size_t columns = 1; columns < scale; columns *= 2)
        halves = {doubled(halves[0] & 0xffffffff), doubled(halves[0] >> 32)};
    return halves;
}

/// Shows a row of texels in `scale` rows of one half, where bits are fresh.
template <std::size_t scale>
HWY_INLINE void copy_row(const std::uint32_t* texels, const std::array<std::uint64_t, scale>& fresh,
                         std::uint64_t any_fresh, std::uint32_t* out) {
    const U u;
    const auto texel = hn::IndicesFromVec(u, hn::ShiftRight<std::countr_zero(scale)>(hn::Iota(u, 0)));
    for (std::size_t place = 0; place < 64; place += hn::Lanes(u)) {
        if ((any_fresh >> place & ((std::uint64_t{1} << hn::Lanes(u)) - 1)) == 0) continue;
        const VU stretched = hn::TableLookupLanes(hn::LoadU(u, texels + place / scale), texel);
        for (std::size_t row = 0; row < scale; ++row)
            replace(lanes_of_bits(fresh[row] >> place), stretched, out + row * mask_side + place);
    }
}

template <std::size_t scale>
bool copy_all_missed_at(const RecordTexture& texture, const Canvas& canvas) {
    std::uint64_t any = 0;
    for (std::size_t v = 0; v < mask_side / scale; ++v) {
        const std::array<std::uint64_t, 2> missed = missed_halves<scale>(texture.missed.data(), v);
        for (std::size_t half = 0; half < 2; ++half) {
            std::uint64_t *const open = &canvas.open.halves[half][v * scale],
                                 *const lit = &canvas.lit.halves[half][v * scale];
            std::array<std::uint64_t, scale> fresh;
            std::uint64_t any_fresh = 0;
            for (std::size_t row = 0; row < scale; ++row) {
                fresh[row] = missed[half] & open[row];
                lit[row] |= fresh[row];
                open[row] &= ~fresh[row];
                any_fresh |= fresh[row];
            }
            if (any_fresh == 0) continue;
            any |= any_fresh;
            const std::size_t from = v * texture.side + 64 * half / scale,
                              to = v * scale * mask_side + 64 * half;
            copy_row<scale>(&texture.radiance[from], fresh, any_fresh, &canvas.radiance[to]);
            if (!canvas.direct.empty())
                copy_row<scale>(&texture.direct[from], fresh, any_fresh, &canvas.direct[to]);
        }
    }
    return any != 0;
}

bool copy_all_missed(const RecordTexture& texture, const Canvas& canvas) {
    switch (texture.side) {
        case 128:
            return copy_all_missed_at<1>(texture, canvas);
        case 64:
            return copy_all_missed_at<2>(texture, canvas);
        case 32:
            return copy_all_missed_at<4>(texture, canvas);
        default:
            return copy_all_missed_at<8>(texture, canvas);  // 16, the least
    }
}

bool draw_all(std::span<const BitRect> masks, const DrawnSurfels& surfels, const RecordTexture& texture,
              const Canvas& canvas) {
    if (surfels.colored == 0) return take(masks, canvas.open);
    paint_all(masks.first(surfels.colored), surfels.texels, texture, canvas);
    const SplitMask before = canvas.open;
    const bool any = take(masks.first(surfels.colored), canvas.open);
    for (std::size_t half = 0; half < 2; ++half)
        for (std::size_t y = 0; y < mask_side; ++y)
            canvas.lit.halves[half][y] |= before.halves[half][y] & ~canvas.open.halves[half][y];
    return take(masks.subspan(surfels.colored), canvas.open) || any;
}

/// Trails are many and long: only their union touches the other masks.
void close_all(std::span<const BitRect> trails, SplitMask& closed, SplitMask& open, SplitMask& unknown) {
    for_windows(trails, [&](const Windows& windows) HWY_ATTR {
        windows.for_each_word(closed, [](std::uint64_t* words, VR bits) HWY_ATTR {
            hn::Store(hn::Or(hn::Load(R(), words), bits), R(), words);
        });
    });
    const Rows rows(trails);
    for (std::size_t half = 0; half < 2; ++half)
        for (std::size_t y = rows.first / hn::Lanes(R()) * hn::Lanes(R()); y < rows.last;
             y += hn::Lanes(R())) {
            std::uint64_t *const open_words = &open.halves[half][y], *const words = &unknown.halves[half][y];
            const VR before = hn::Load(R(), open_words), taken = hn::Load(R(), &closed.halves[half][y]);
            hn::Store(hn::Or(hn::Load(R(), words), hn::And(before, taken)), R(), words);
            hn::Store(hn::AndNot(taken, before), R(), open_words);
        }
}

void split_rest(const Mask& covered, SplitMask& open) {
    for (std::size_t y = 0; y < mask_side; y += hn::Lanes(R())) {
        VR low, high;
        hn::LoadInterleaved2(R(), &covered.rows[y].low, low, high);
        hn::Store(hn::Not(low), R(), &open.halves[0][y]);
        hn::Store(hn::Not(high), R(), &open.halves[1][y]);
    }
}

void join_all(const SplitMask& mask, Mask& out) {
    for (std::size_t y = 0; y < mask_side; y += hn::Lanes(R()))
        hn::StoreInterleaved2(hn::Load(R(), &mask.halves[0][y]), hn::Load(R(), &mask.halves[1][y]), R(),
                              &out.rows[y].low);
}

}  // namespace
}  // namespace relumine::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace relumine {

HWY_EXPORT(draw_all);
HWY_EXPORT(draw_all_missed);
HWY_EXPORT(copy_all_missed);
HWY_EXPORT(close_all);
HWY_EXPORT(split_rest);
HWY_EXPORT(join_all);

bool draw_surfels(std::span<const BitRect> masks, const DrawnSurfels& surfels, const RecordTexture& texture,
                  const Canvas& canvas) {
    return HWY_DYNAMIC_DISPATCH(draw_all)(masks, surfels, texture, canvas);
}

bool draw_missed(std::span<const BitRect> masks, std::span<const TexelRect> texels,
                 const RecordTexture& texture, const Canvas& canvas) {
    return HWY_DYNAMIC_DISPATCH(draw_all_missed)(masks, texels, texture, canvas);
}

bool copy_missed(const RecordTexture& texture, const Canvas& canvas) {
    return HWY_DYNAMIC_DISPATCH(copy_all_missed)(texture, canvas);
}

void close_trails(std::span<const BitRect> trails, SplitMask& closed, SplitMask& open, SplitMask& unknown) {
    HWY_DYNAMIC_DISPATCH(close_all)(trails, closed, open, unknown);
}

SplitMask rest_of(const Mask& covered) {
    SplitMask open;
    HWY_DYNAMIC_DISPATCH(split_rest)(covered, open);
    return open;
}

void join(const SplitMask& mask, Mask& out) { HWY_DYNAMIC_DISPATCH(join_all)(mask, out); }

}  // namespace relumine
#endif
