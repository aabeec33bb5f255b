// SPDX-License-Identifier: Apache-2.0
// sample_stream.cpp and sobol.hpp in SIMD lanes; names as there.
#include "base/sample_packet_kernel.hpp"

#include <algorithm>

#include "base/sobol.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "base/sample_packet_kernel.cpp"
#include <hwy/foreach_target.h>  // compiles this file once per instruction set
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace relumine {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using D32 = hn::CappedTag<std::uint32_t, packet_size>;
#if HWY_TARGET == HWY_SCALAR
using D64 = hn::CappedTag<std::uint64_t, 1>;
#else
using D64 = hn::RepartitionToWide<D32>;
#endif
using DF = hn::RebindToFloat<D32>;
using V32 = hn::Vec<D32>;
using V64 = hn::Vec<D64>;
using VF = hn::Vec<DF>;

/// 64-bit values of as many lanes as a vector of 32-bit values has.
struct Wide {
    V64 first, second;
};

#if HWY_TARGET == HWY_SCALAR  // one lane: `first` holds it
HWY_INLINE V32 low(Wide x) { return hn::Set(D32(), static_cast<std::uint32_t>(hn::GetLane(x.first))); }
HWY_INLINE V32 high(Wide x) { return hn::Set(D32(), static_cast<std::uint32_t>(hn::GetLane(x.first) >> 32)); }
HWY_INLINE Wide load(const std::uint64_t* from) { return {hn::Load(D64(), from), hn::Load(D64(), from)}; }
#else
HWY_INLINE V32 low(Wide x) {
    return hn::ConcatEven(D32(), hn::BitCast(D32(), x.second), hn::BitCast(D32(), x.first));
}
HWY_INLINE V32 high(Wide x) {
    return hn::ConcatOdd(D32(), hn::BitCast(D32(), x.second), hn::BitCast(D32(), x.first));
}
HWY_INLINE Wide load(const std::uint64_t* from) {
    return {hn::Load(D64(), from), hn::Load(D64(), from + hn::Lanes(D64()))};
}
#endif

HWY_INLINE V64 mix(V64 x) {
    x = hn::Xor(x, hn::ShiftRight<31>(x));
    x = hn::Mul(x, hn::Set(D64(), 0x7fb5d329728ea185u));
    x = hn::Xor(x, hn::ShiftRight<27>(x));
    x = hn::Mul(x, hn::Set(D64(), 0x81dadef4bc2dd44du));
    return hn::Xor(x, hn::ShiftRight<33>(x));
}

HWY_INLINE Wide mix(Wide x) { return {mix(x.first), mix(x.second)}; }

HWY_INLINE Wide dimension_keys(const std::uint64_t* keys, std::uint64_t dimension) {
    const Wide key = load(keys);
    const V64 bits = hn::Set(D64(), dimension);
    return mix(Wide{hn::Xor(key.first, bits), hn::Xor(key.second, bits)});
}

HWY_INLINE Wide hash(Wide key, const std::uint64_t* index_hashes) {
    const Wide index = load(index_hashes);
    return mix(Wide{hn::Xor(key.first, index.first), hn::Xor(key.second, index.second)});
}

#if HWY_TARGET == HWY_SCALAR
/// The bits of `x` that `mask` has go `shift` places up, the ones that many places higher come down.
template <int shift>
HWY_INLINE V32 swap_groups(V32 x, std::uint32_t mask) {
    const V32 lower = hn::Set(D32(), mask);
    return hn::Or(hn::ShiftLeft<shift>(hn::And(x, lower)), hn::And(hn::ShiftRight<shift>(x), lower));
}

HWY_INLINE V32 reverse_bits(V32 x) {
    x = hn::Or(hn::ShiftLeft<16>(x), hn::ShiftRight<16>(x));
    x = swap_groups<8>(x, 0x00ff00ffu);
    x = swap_groups<4>(x, 0x0f0f0f0fu);
    x = swap_groups<2>(x, 0x33333333u);
    return swap_groups<1>(x, 0x55555555u);
}
#else
alignas(16) constexpr std::uint8_t reversed_nibbles[16] = {0, 8, 4, 12, 2, 10, 6, 14,
                                                           1, 9, 5, 13, 3, 11, 7, 15};
alignas(16) constexpr std::uint8_t reversed_bytes[16] = {3,  2,  1, 0, 7,  6,  5,  4,
                                                         11, 10, 9, 8, 15, 14, 13, 12};

HWY_INLINE V32 reverse_bits(V32 x) {
    const hn::Repartition<std::uint8_t, D32> bytes;
    const V32 lower = hn::Set(D32(), 0x0f0f0f0fu);
    const auto table = hn::LoadDup128(bytes, reversed_nibbles);
    const auto look_up = [&](V32 nibbles) {
        return hn::BitCast(D32(), hn::TableLookupBytes(table, hn::BitCast(bytes, nibbles)));
    };
    const V32 in_bytes =
        hn::Or(hn::ShiftLeft<4>(look_up(hn::And(x, lower))), look_up(hn::And(hn::ShiftRight<4>(x), lower)));
    return hn::BitCast(
        D32(), hn::TableLookupBytes(hn::BitCast(bytes, in_bytes), hn::LoadDup128(bytes, reversed_bytes)));
}
#endif

HWY_INLINE V32 multiply_xor(V32 x, std::uint32_t factor) {
    return hn::Xor(x, hn::Mul(x, hn::Set(D32(), factor)));
}

HWY_INLINE V32 laine_karras(V32 x, V32 seed) {
    x = multiply_xor(x, 0x3d20adeau);
    x = hn::Add(x, seed);
    x = hn::Mul(x, hn::Or(hn::ShiftRight<16>(seed), hn::Set(D32(), 1)));
    x = multiply_xor(x, 0x05526c56u);
    return multiply_xor(x, 0x53a22864u);
}

template <int shift>
HWY_INLINE V32 add_upper(V32 x, std::uint32_t mask) {
    return hn::Xor(x, hn::ShiftRight<shift>(hn::And(x, hn::Set(D32(), mask))));
}

HWY_INLINE V32 sobol_second_reversed(V32 index) {
    index = add_upper<16>(index, 0xffff0000u);
    index = add_upper<8>(index, 0xff00ff00u);
    index = add_upper<4>(index, 0xf0f0f0f0u);
    index = add_upper<2>(index, 0xccccccccu);
    return add_upper<1>(index, 0xaaaaaaaau);
}

HWY_INLINE VF unit_float(V32 bits) {
    const hn::RebindToSigned<D32> signed_lanes;
    return hn::Mul(hn::ConvertTo(DF(), hn::BitCast(signed_lanes, hn::ShiftRight<8>(bits))),
                   hn::Set(DF(), 0x1p-24f));
}

HWY_INLINE V32 shuffled(V32 reversed_index, V32 seed) {
    return reverse_bits(laine_karras(reversed_index, seed));
}

HWY_INLINE VF scrambled(V32 x, V32 seed) { return unit_float(reverse_bits(laine_karras(x, seed))); }

void sobol1(const std::uint64_t* keys, const std::uint32_t* reversed, std::uint64_t dimension, float* u) {
    for (std::size_t i = 0; i < packet_size; i += hn::Lanes(D32())) {
        const Wide key = dimension_keys(keys + i, dimension);
        const V32 index = shuffled(hn::Load(D32(), reversed + i), low(key));
        hn::StoreU(scrambled(index, high(key)), DF(), u + i);
    }
}

void sobol2(const std::uint64_t* keys, const std::uint32_t* reversed, std::uint64_t dimension, float* x,
            float* y) {
    const V64 other = hn::Set(D64(), 0xd1342543de82ef95u);
    for (std::size_t i = 0; i < packet_size; i += hn::Lanes(D32())) {
        const Wide key = dimension_keys(keys + i, dimension);
        const Wide second_key{hn::Mul(key.first, other), hn::Mul(key.second, other)};
        const V32 index = shuffled(hn::Load(D32(), reversed + i), low(key));
        hn::StoreU(scrambled(index, high(key)), DF(), x + i);
        hn::StoreU(scrambled(sobol_second_reversed(index), high(second_key)), DF(), y + i);
    }
}

void random_floats(const std::uint64_t* keys, const std::uint64_t* index_hashes, std::uint64_t dimension,
                   float* x, float* y) {
    for (std::size_t i = 0; i < packet_size; i += hn::Lanes(D32())) {
        const Wide random = hash(dimension_keys(keys + i, dimension), index_hashes + i);
        hn::StoreU(unit_float(low(random)), DF(), x + i);
        hn::StoreU(unit_float(high(random)), DF(), y + i);
    }
}

void random_bits(const std::uint64_t* keys, const std::uint64_t* index_hashes, std::uint64_t dimension,
                 std::uint32_t* bits) {
    for (std::size_t i = 0; i < packet_size; i += hn::Lanes(D32()))
        hn::StoreU(low(hash(dimension_keys(keys + i, dimension), index_hashes + i)), D32(), bits + i);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace relumine
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace relumine {

HWY_EXPORT(sobol1);
HWY_EXPORT(sobol2);
HWY_EXPORT(random_floats);
HWY_EXPORT(random_bits);

SamplePacket::SamplePacket(std::span<const SampleStream, packet_size> streams) : set_(streams[0].set) {
    mixed_or_stratified_ =
        set_ == PointSet::stratified
        || std::ranges::any_of(streams, [&](const SampleStream& s) { return s.set != set_; });
    for (std::size_t i = 0; i < packet_size; ++i) {
        streams_[i] = &streams[i];
        keys_[i] = streams[i].key;
        index_hashes_[i] = mix(streams[i].index + 0x9e3779b97f4a7c15u);
        reversed_indices_[i] = reverse_bits(streams[i].index);
    }
}

void SamplePacket::take(std::size_t lane, const SamplePacket& other, std::size_t other_lane) {
    mixed_or_stratified_ = mixed_or_stratified_ || other.mixed_or_stratified_ || set_ != other.set_;
    streams_[lane] = other.streams_[other_lane];
    keys_[lane] = other.keys_[other_lane];
    index_hashes_[lane] = other.index_hashes_[other_lane];
    reversed_indices_[lane] = other.reversed_indices_[other_lane];
}

void SamplePacket::next1(Dim dim, std::uint32_t vertex, Lanes<float>& u) const {
    const std::uint64_t dimension = dimension_bits(dim, vertex);
    if (mixed_or_stratified_) {
        for (std::size_t i = 0; i < packet_size; ++i) u[i] = streams_[i]->next1(dim, vertex);
    } else if (set_ == PointSet::sobol) {
        HWY_DYNAMIC_DISPATCH(sobol1)(keys_.data(), reversed_indices_.data(), dimension, u.data());
    } else {
        Lanes<float> unused;
        HWY_DYNAMIC_DISPATCH(random_floats)
        (keys_.data(), index_hashes_.data(), dimension, u.data(), unused.data());
    }
}

void SamplePacket::next2(Dim dim, std::uint32_t vertex, Lanes<float>& x, Lanes<float>& y) const {
    const std::uint64_t dimension = dimension_bits(dim, vertex);
    if (mixed_or_stratified_) {
        for (std::size_t i = 0; i < packet_size; ++i) {
            const Point2 u = streams_[i]->next2(dim, vertex);
            x[i] = u.x;
            y[i] = u.y;
        }
    } else if (set_ == PointSet::sobol) {
        HWY_DYNAMIC_DISPATCH(sobol2)
        (keys_.data(), reversed_indices_.data(), dimension, x.data(), y.data());
    } else {
        HWY_DYNAMIC_DISPATCH(random_floats)
        (keys_.data(), index_hashes_.data(), dimension, x.data(), y.data());
    }
}

void SamplePacket::bits(Dim dim, std::uint32_t vertex, Lanes<std::uint32_t>& bits) const {
    HWY_DYNAMIC_DISPATCH(random_bits)
    (keys_.data(), index_hashes_.data(), dimension_bits(dim, vertex), bits.data());
}

}  // namespace relumine
#endif  // HWY_ONCE
