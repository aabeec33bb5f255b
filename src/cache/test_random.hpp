// SPDX-License-Identifier: Apache-2.0
// Numbers for tests of kernels: the same in every build.
#pragma once

#include "base/hash.hpp"
#include "base/vec.hpp"

namespace relumine::testing {

/// In [low, high); a hash of `i` and of what it is for.
inline float uniform(std::uint64_t i, std::uint64_t what, float low, float high) {
    return low + (high - low) * unit_float(static_cast<std::uint32_t>(hash(i, what)));
}

/// Uniform over the sphere.
inline Vec3 random_direction(std::uint64_t i, std::uint64_t what) {
    const float z = uniform(i, what, -1, 1), phi = uniform(i, what + 1, 0, 2 * pi), r = std::sqrt(1 - z * z);
    return {r * std::cos(phi), r * std::sin(phi), z};
}

}  // namespace relumine::testing
