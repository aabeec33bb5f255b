// SPDX-License-Identifier: Apache-2.0
// The projection kernel. Sums and products stay apart (no fused multiply-add), so that every target rounds
// alike.
#include "cache/project_kernel.hpp"

#include "cache/hemisphere_map.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "cache/project_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace relumine::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using F = hn::CappedTag<float, surfel_padding>;
using I = hn::Rebind<std::int32_t, F>;
using U = hn::Rebind<std::uint32_t, F>;
using VF = hn::Vec<F>;
using VI = hn::Vec<I>;
using VU = hn::Vec<U>;

HWY_INLINE VF multiply_add(VF a, VF b, VF c) { return hn::Add(hn::Mul(a, b), c); }

struct Vec3s {
    VF x, y, z;
};
HWY_INLINE VF dot(const Vec3s& a, Vec3 b) {
    const F f;
    return hn::Add(hn::Add(hn::Mul(a.x, hn::Set(f, b.x)), hn::Mul(a.y, hn::Set(f, b.y))),
                   hn::Mul(a.z, hn::Set(f, b.z)));
}

struct SquarePoint {
    VF x, y, cosine;  // bits; of the angle to the normal
};

HWY_INLINE VF octant_of(VF x) {
    const F f;
    const VF x2 = hn::Mul(x, x);
    VF sum = hn::Set(f, short_octant_polynomial.back());
    for (std::size_t i = short_octant_polynomial.size() - 1; i-- > 0;)
        sum = multiply_add(sum, x2, hn::Set(f, short_octant_polynomial[i]));
    return hn::Mul(sum, x);
}

HWY_INLINE Vec3s add(const Vec3s& a, const Vec3s& b) {
    return {hn::Add(a.x, b.x), hn::Add(a.y, b.y), hn::Add(a.z, b.z)};
}

/// hemisphere_to_square of a vector that need not be unit, in bits.
HWY_INLINE SquarePoint to_square(const Vec3s& w) {
    const F f;
    const VF length2 = hn::Add(hn::Add(hn::Mul(w.x, w.x), hn::Mul(w.y, w.y)), hn::Mul(w.z, w.z));
    const VF length = hn::Sqrt(length2), ax = hn::Abs(w.x), ay = hn::Abs(w.y);
    const auto x_major = hn::Ge(ax, ay);
    const VF major = hn::Max(hn::Max(ax, ay), hn::Mul(length, hn::Set(f, 1e-12f)));
    // One division for two: 1 / length and minor / major.
    const VF inverse = hn::Div(hn::Set(f, 1), hn::Max(hn::Mul(length, major), hn::Set(f, 1e-37f)));
    const VF cosine = hn::Mul(w.z, hn::Mul(major, inverse));
    const VF r = hn::Sqrt(hn::Max(hn::Zero(f), hn::Sub(hn::Set(f, 1), cosine)));
    const VF ratio = hn::Min(hn::Mul(hn::Min(ax, ay), hn::Mul(length, inverse)), hn::Set(f, 1));
    const VF across = hn::Mul(r, octant_of(ratio));
    const VF half_side = hn::Set(f, 0.5f * mask_side);
    const auto bits = [&](VF magnitude, VF sign) {
        return multiply_add(half_side, hn::CopySign(magnitude, sign), half_side);
    };
    return {bits(hn::IfThenElse(x_major, r, across), w.x), bits(hn::IfThenElse(x_major, across, r), w.y),
            cosine};
}

struct Box {
    VF x0, x1, y0, y1;  // bits
};

HWY_INLINE Box bounds(const SquarePoint (&p)[4]) {
    const auto least = [](VF a, VF b, VF c, VF d) { return hn::Min(hn::Min(a, b), hn::Min(c, d)); };
    const auto most = [](VF a, VF b, VF c, VF d) { return hn::Max(hn::Max(a, b), hn::Max(c, d)); };
    return {least(p[0].x, p[1].x, p[2].x, p[3].x), most(p[0].x, p[1].x, p[2].x, p[3].x),
            least(p[0].y, p[1].y, p[2].y, p[3].y), most(p[0].y, p[1].y, p[2].y, p[3].y)};
}

HWY_INLINE Box enclosing(const Box& a, const Box& b) {
    return {hn::Min(a.x0, b.x0), hn::Max(a.x1, b.x1), hn::Min(a.y0, b.y0), hn::Max(a.y1, b.y1)};
}

HWY_INLINE Box choose(hn::Mask<F> first, const Box& a, const Box& b) {
    return {hn::IfThenElse(first, a.x0, b.x0), hn::IfThenElse(first, a.x1, b.x1),
            hn::IfThenElse(first, a.y0, b.y0), hn::IfThenElse(first, a.y1, b.y1)};
}

/// The first bit whose centre is not before `edge`.
HWY_INLINE VU first_bit(VF edge) {
    const F f;
    const VF bit = hn::Ceil(hn::Sub(edge, hn::Set(f, 0.5f)));
    const VF inside = hn::Min(hn::Max(bit, hn::Zero(f)), hn::Set(f, mask_side));
    return hn::BitCast(U(), hn::ConvertTo(I(), inside));
}

/// As the four bytes of BitRect.
HWY_INLINE VU pack(const Box& box) {
    const VU x = hn::Or(first_bit(box.x0), hn::ShiftLeft<8>(first_bit(box.x1)));
    const VU y = hn::Or(first_bit(box.y0), hn::ShiftLeft<8>(first_bit(box.y1)));
    return hn::Or(x, hn::ShiftLeft<16>(y));
}

/// In the receiver's frame, as seen from the record.
template <bool rotated>
HWY_INLINE Vec3s corner(const Surfels& surfels, std::size_t at, std::size_t number, const Frame& turn) {
    const F f;
    const hn::Rebind<hwy::float16_t, F> h;
    const auto plane = [&](std::size_t axis) {
        const std::uint16_t* halves = &surfels.corners[(3 * number + axis) * surfels.stride + at];
        return hn::PromoteTo(f, hn::LoadU(h, reinterpret_cast<const hwy::float16_t*>(halves)));
    };
    const Vec3s q{plane(0), plane(1), plane(2)};
    if constexpr (!rotated) return q;
    return {dot(q, turn.s), dot(q, turn.t), dot(q, turn.n)};
}

/// The surfels' rectangles of texels, in bits.
HWY_INLINE Box texel_box(const Surfels& surfels, std::size_t at, float bits_per_texel) {
    const F f;
    const VU packed = hn::LoadU(U(), reinterpret_cast<const std::uint32_t*>(&surfels.texels[at]));
    const VF scale = hn::Set(f, bits_per_texel);
    const auto byte = [&](VU shifted_down) {
        return hn::Mul(hn::ConvertTo(f, hn::BitCast(I(), hn::And(shifted_down, hn::Set(U(), 255)))), scale);
    };
    const VF x0 = byte(packed), y0 = byte(hn::ShiftRight<8>(packed));
    return {x0, hn::Add(x0, byte(hn::ShiftRight<16>(packed))), y0,
            hn::Add(y0, byte(hn::ShiftRight<24>(packed)))};
}

HWY_INLINE hn::Mask<F> above_horizon(const SquarePoint (&p)[4]) {
    return hn::Gt(hn::Max(hn::Max(p[0].cosine, p[1].cosine), hn::Max(p[2].cosine, p[3].cosine)),
                  hn::Zero(F()));
}

/// Whether corners run the same way round as in the record, and the surfel does not look too large.
HWY_INLINE hn::Mask<F> usable(const SquarePoint (&p)[4], const Box& box, const Box& texels) {
    const F f;
    const VF ux = hn::Sub(p[3].x, p[0].x), uy = hn::Sub(p[3].y, p[0].y);
    const VF vx = hn::Sub(p[1].x, p[2].x), vy = hn::Sub(p[1].y, p[2].y);
    const auto faces = hn::Gt(hn::Sub(hn::Mul(vx, uy), hn::Mul(vy, ux)), hn::Zero(f));
    const auto allowed = [&](VF low, VF high) {
        return multiply_add(hn::Sub(high, low), hn::Set(f, largest_growth), hn::Set(f, growth_margin));
    };
    const auto fits = hn::And(hn::Le(hn::Sub(box.x1, box.x0), allowed(texels.x0, texels.x1)),
                              hn::Le(hn::Sub(box.y1, box.y0), allowed(texels.y0, texels.y1)));
    return hn::And(faces, fits);
}

/// A box of the same size around another point, halved.
HWY_INLINE Box centered(const Box& size, const SquarePoint& center) {
    const F f;
    const VF half = hn::Set(f, 0.5f);
    const VF width = hn::Mul(hn::Sub(size.x1, size.x0), half),
             height = hn::Mul(hn::Sub(size.y1, size.y0), half);
    return {hn::Sub(center.x, width), hn::Add(center.x, width), hn::Sub(center.y, height),
            hn::Add(center.y, height)};
}

template <bool rotated>
void project_each(const Surfels& surfels, std::size_t begin, std::size_t end, const Projection& projection,
                  BitRect* masks, BitRect* trails) {
    const U u;
    const F f;
    const float bits_per_texel = static_cast<float>(mask_side) / static_cast<float>(projection.side);
    const Vec3 shift = projection.shift / surfels.scale;
    const Vec3s shifts{hn::Set(f, shift.x), hn::Set(f, shift.y), hn::Set(f, shift.z)};
    for (std::size_t i = begin; i < end; i += hn::Lanes(u)) {
        SquarePoint now[4];
        Vec3s middle{hn::Zero(f), hn::Zero(f), hn::Zero(f)};
        const auto project_corner = [&](std::size_t c) HWY_ATTR {
            const Vec3s q = corner<rotated>(surfels, i, c, projection.turn);
            now[c] = to_square(add(q, shifts));
            if constexpr (rotated) middle = add(middle, q);
        };
        // Not a loop, which would leave the corners in memory.
        project_corner(0);
        project_corner(1);
        project_corner(2);
        project_corner(3);
        const Box texels = texel_box(surfels, i, bits_per_texel), mask = bounds(now);
        const auto above = above_horizon(now), used = hn::And(above, usable(now, mask, texels));
        hn::StoreU(hn::IfThenElseZero(hn::RebindMask(u, used), pack(mask)), u,
                   reinterpret_cast<std::uint32_t*>(masks + (i - begin)));
        const Box old = rotated ? centered(texels, to_square(middle)) : texels;
        hn::StoreU(pack(choose(above, enclosing(old, mask), old)), u,
                   reinterpret_cast<std::uint32_t*>(trails + (i - begin)));
    }
}

void project(const Surfels& surfels, std::size_t begin, std::size_t end, const Projection& projection,
             BitRect* masks, BitRect* trails) {
    if (projection.rotated)
        project_each<true>(surfels, begin, end, projection, masks, trails);
    else
        project_each<false>(surfels, begin, end, projection, masks, trails);
}

}  // namespace
}  // namespace relumine::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace relumine {

HWY_EXPORT(project);

void project_surfels(const Surfels& surfels, std::size_t begin, std::size_t end, const Projection& projection,
                     std::span<BitRect> masks, std::span<BitRect> trails) {
    HWY_DYNAMIC_DISPATCH(project)(surfels, begin, end, projection, masks.data(), trails.data());
}

}  // namespace relumine
#endif
