// SPDX-License-Identifier: Apache-2.0
// The first two Sobol dimensions with hash-based Owen scrambling [Burley20].
#pragma once

#include <cstdint>

namespace relumine {

constexpr std::uint32_t reverse_bits(std::uint32_t x) {
    x = __builtin_bswap32(x);
    x = ((x & 0x0f0f0f0fu) << 4) | ((x >> 4) & 0x0f0f0f0fu);
    x = ((x & 0x33333333u) << 2) | ((x >> 2) & 0x33333333u);
    return ((x & 0x55555555u) << 1) | ((x >> 1) & 0x55555555u);
}

/// A random bijection in which a bit depends on the lower bits alone [Laine11, constants of Vegdahl21].
constexpr std::uint32_t laine_karras(std::uint32_t x, std::uint32_t seed) {
    x ^= x * 0x3d20adeau;
    x += seed;
    x *= (seed >> 16) | 1u;
    x ^= x * 0x05526c56u;
    x ^= x * 0x53a22864u;
    return x;
}

/// Owen scrambling: a random bijection in which a bit depends on the higher bits alone.
constexpr std::uint32_t owen_scramble(std::uint32_t x, std::uint32_t seed) {
    return reverse_bits(laine_karras(reverse_bits(x), seed));
}

/// The second Sobol dimension of `index`, bit-reversed. Its generator matrix is Pascal's triangle mod 2, that
/// is the substitution x → x + 1 in the polynomial over GF(2) with these bits, which takes five steps.
constexpr std::uint32_t sobol_second_reversed(std::uint32_t index) {
    index ^= (index & 0xffff0000u) >> 16;
    index ^= (index & 0xff00ff00u) >> 8;
    index ^= (index & 0xf0f0f0f0u) >> 4;
    index ^= (index & 0xccccccccu) >> 2;
    index ^= (index & 0xaaaaaaaau) >> 1;
    return index;
}

}  // namespace relumine
