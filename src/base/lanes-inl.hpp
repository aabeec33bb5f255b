// SPDX-License-Identifier: Apache-2.0
// Vectors of the packet's lanes, for kernels: include after hwy/highway.h; once per instruction set.
#if defined(RELUMINE_BASE_LANES_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef RELUMINE_BASE_LANES_INL_HPP
#undef RELUMINE_BASE_LANES_INL_HPP
#else
#define RELUMINE_BASE_LANES_INL_HPP
#endif

#include "base/lanes.hpp"

HWY_BEFORE_NAMESPACE();
namespace relumine {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using F = hn::CappedTag<float, packet_size>;
using I = hn::RebindToSigned<F>;
using VF = hn::Vec<F>;
using VI = hn::Vec<I>;
using Mask = hn::Mask<F>;

HWY_INLINE VF constant(float x) { return hn::Set(F(), x); }
HWY_INLINE VF zero() { return hn::Zero(F()); }
HWY_INLINE VF squared(VF x) { return x * x; }
HWY_INLINE VF select(Mask condition, VF yes, VF no) { return hn::IfThenElse(condition, yes, no); }
HWY_INLINE VF load(const Lanes<float>& from, std::size_t i) { return hn::Load(F(), from.data() + i); }
HWY_INLINE void store(VF x, Lanes<float>& to, std::size_t i) { hn::Store(x, F(), to.data() + i); }
HWY_INLINE Mask load(const LaneMask& from, std::size_t i) {
    return hn::RebindMask(F(), hn::Lt(hn::Load(I(), from.data() + i), hn::Zero(I())));
}

HWY_INLINE void store(Mask mask, LaneMask& to, std::size_t i) {
    hn::Store(hn::VecFromMask(I(), hn::RebindMask(I(), mask)), I(), to.data() + i);
}

struct V3 {
    VF x, y, z;
};
HWY_INLINE V3 operator+(V3 a, V3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
HWY_INLINE V3 operator-(V3 a, V3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
HWY_INLINE V3 operator-(V3 a) { return {hn::Neg(a.x), hn::Neg(a.y), hn::Neg(a.z)}; }
HWY_INLINE V3 operator*(V3 a, V3 b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }  // of spectra
HWY_INLINE V3 operator*(V3 a, VF s) { return {a.x * s, a.y * s, a.z * s}; }
HWY_INLINE V3 operator/(V3 a, VF s) { return a * (constant(1) / s); }
HWY_INLINE VF dot(V3 a, V3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
HWY_INLINE V3 cross(V3 a, V3 b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
HWY_INLINE VF length(V3 a) { return hn::Sqrt(dot(a, a)); }
HWY_INLINE V3 normalize(V3 a) { return a / length(a); }
HWY_INLINE VF max_abs(V3 a) { return hn::Max(hn::Max(hn::Abs(a.x), hn::Abs(a.y)), hn::Abs(a.z)); }
HWY_INLINE VF max_component(V3 a) { return hn::Max(hn::Max(a.x, a.y), a.z); }
HWY_INLINE V3 select(Mask condition, V3 yes, V3 no) {
    return {select(condition, yes.x, no.x), select(condition, yes.y, no.y), select(condition, yes.z, no.z)};
}
HWY_INLINE Mask is_black(V3 s) {
    return hn::And(hn::And(hn::Eq(s.x, zero()), hn::Eq(s.y, zero())), hn::Eq(s.z, zero()));
}

HWY_INLINE V3 load(const Vec3Lanes& from, std::size_t i) {
    return {load(from.x, i), load(from.y, i), load(from.z, i)};
}
HWY_INLINE V3 load(const SpectrumLanes& from, std::size_t i) {
    return {load(from.r, i), load(from.g, i), load(from.b, i)};
}
HWY_INLINE void store(V3 v, Vec3Lanes& to, std::size_t i) {
    store(v.x, to.x, i);
    store(v.y, to.y, i);
    store(v.z, to.z, i);
}
HWY_INLINE void store(V3 v, SpectrumLanes& to, std::size_t i) {
    store(v.x, to.r, i);
    store(v.y, to.g, i);
    store(v.z, to.b, i);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace relumine
HWY_AFTER_NAMESPACE();
#endif
