// SPDX-License-Identifier: Apache-2.0
// Counter-based random numbers: a hash of what the number is for, never the state of a thread.
#pragma once

#include <cstdint>

namespace relumine {

/// A bijection of 64 bits that flips every output bit with probability ½ for each flipped input bit
/// [Stafford11].
constexpr std::uint64_t mix(std::uint64_t x) {
    x ^= x >> 31;
    x *= 0x7fb5d329728ea185u;
    x ^= x >> 27;
    x *= 0x81dadef4bc2dd44du;
    x ^= x >> 33;
    return x;
}

constexpr std::uint64_t hash(std::uint64_t a, std::uint64_t b) {
    return mix(a ^ mix(b + 0x9e3779b97f4a7c15u));
}
template <typename... Rest>
constexpr std::uint64_t hash(std::uint64_t a, std::uint64_t b, Rest... rest) {
    return hash(hash(a, b), static_cast<std::uint64_t>(rest)...);
}

/// The upper 24 bits as a float in [0, 1).
constexpr float unit_float(std::uint32_t bits) { return static_cast<float>(bits >> 8) * 0x1p-24f; }

}  // namespace relumine
