// SPDX-License-Identifier: Apache-2.0
// The projection kernel. Sums and products stay apart (no fused multiply-add), so that every target rounds
// alike.
#include "blocks/record_projection.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "blocks/record_projection.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace relumine::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using F = hn::CappedTag<float, packet_size>;
using I = hn::Rebind<std::int32_t, F>;
using U = hn::Rebind<std::uint32_t, F>;
using VF = hn::Vec<F>;
using VU = hn::Vec<U>;

HWY_INLINE VF constant(float x) { return hn::Set(F(), x); }

HWY_INLINE VF octant_of(VF x) {
    const VF x2 = hn::Mul(x, x);
    VF sum = constant(octant_polynomial.back());
    for (std::size_t i = octant_polynomial.size() - 1; i-- > 0;)
        sum = hn::Add(hn::Mul(sum, x2), constant(octant_polynomial[i]));
    return hn::Mul(sum, x);
}

struct SquarePoint {
    VF x, y;  // [0, 1]
};

/// sphere_to_square of a vector that need not be unit.
HWY_INLINE SquarePoint to_square(VF x, VF y, VF z, VF length) {
    const VF one = constant(1), half = constant(0.5f);
    const VF ax = hn::Abs(x), ay = hn::Abs(y);
    const VF height = hn::Div(hn::Abs(z), hn::Max(length, constant(1e-30f)));
    const VF r = hn::Sqrt(hn::Max(hn::Zero(F()), hn::Sub(one, height)));
    const VF major = hn::Max(ax, ay), minor = hn::Min(ax, ay);
    const VF octant = hn::Mul(half, octant_of(hn::Div(minor, hn::Max(major, constant(1e-30f)))));
    const VF angle = hn::IfThenElse(hn::Lt(ax, ay), hn::Sub(one, octant), octant);
    const VF v = hn::Mul(angle, r), u = hn::Sub(r, v);
    const auto folded = hn::Lt(z, hn::Zero(F()));
    const auto along = [&](VF inside, VF outside, VF sign) {
        const VF magnitude = hn::IfThenElse(folded, hn::Sub(one, outside), inside);
        return hn::Add(hn::Mul(half, hn::CopySign(magnitude, sign)), half);
    };
    return {along(u, v, x), along(v, u, y)};
}

HWY_INLINE VU spread_bits(VU x) {
    const auto step = [](VU v, VU shifted, std::uint32_t mask) {
        return hn::And(hn::Xor(v, shifted), hn::Set(U(), mask));
    };
    x = step(x, hn::ShiftLeft<8>(x), 0x00ff00ffu);
    x = step(x, hn::ShiftLeft<4>(x), 0x0f0f0f0fu);
    x = step(x, hn::ShiftLeft<2>(x), 0x33333333u);
    return step(x, hn::ShiftLeft<1>(x), 0x55555555u);
}

HWY_INLINE VU index_along(VF p, float side) {
    const VF at = hn::Min(hn::Mul(p, constant(side)), constant(side - 1));
    return hn::BitCast(U(), hn::ConvertTo(I(), hn::Max(at, hn::Zero(F()))));
}

void project_all(float side, const MapRecord& record, Vec3 eye, ProjectedPoints& out) {
    const F f;
    const std::size_t lanes = hn::Lanes(f), count = record.x.size();
    for (std::size_t i = 0; i < count; i += lanes) {
        const VF x = hn::Sub(hn::LoadU(f, &record.x[i]), constant(eye.x)),
                 y = hn::Sub(hn::LoadU(f, &record.y[i]), constant(eye.y)),
                 z = hn::Sub(hn::LoadU(f, &record.z[i]), constant(eye.z));
        const VF length2 = hn::Add(hn::Add(hn::Mul(x, x), hn::Mul(y, y)), hn::Mul(z, z));
        const SquarePoint p = to_square(x, y, z, hn::Sqrt(length2));
        const VU texel = hn::Or(spread_bits(index_along(p.x, side)),
                                hn::ShiftLeft<1>(spread_bits(index_along(p.y, side))));
        hn::StoreU(texel, U(), &out.texels[i]);
        hn::StoreU(length2, f, &out.distances2[i]);
    }
}

}  // namespace
}  // namespace relumine::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace relumine {
namespace {
HWY_EXPORT(project_all);
}  // namespace

void project_points(const DirectionGrid& grid, const MapRecord& record, Vec3 eye, ProjectedPoints& out) {
    out.texels.resize(record.x.size());
    out.distances2.resize(record.x.size());
    HWY_DYNAMIC_DISPATCH(project_all)(static_cast<float>(grid.side), record, eye, out);
}

}  // namespace relumine
#endif
