// SPDX-License-Identifier: Apache-2.0
// Where random numbers come from: a function of what they are for, of the pixel, the sample and the seed.
#pragma once

#include <cstdint>

#include "base/hash.hpp"
#include "base/vec.hpp"

namespace relumine {

/// What a draw decides. Adding one does not shift the others.
enum class Dim : std::uint32_t {
    pixel,
    light_choice,
    light_point,
    lobe,
    direction,
    roulette,
    opacity,
    blend,
    lens
};

enum class PointSet : std::uint8_t {
    sobol,        // Owen-scrambled Sobol, each pair of dimensions a (0,2)-sequence of its own [Burley20]
    stratified,   // jittered, correlated multi-jittered in 2-D [Kensler13]: needs the number of samples in
                  // advance
    independent,  // no stratification
};

/// What tells the dimensions of a stream apart; `vertex` counts the scattering vertices of the path.
constexpr std::uint64_t dimension_bits(Dim dim, std::uint32_t vertex) {
    return (16 * std::uint64_t{vertex} + static_cast<std::uint32_t>(dim)) * 0x9e3779b97f4a7c15u;
}

/// One sample's random numbers: element `index` of a point set of `count` elements that `key` scrambles.
struct SampleStream {
    std::uint64_t key = 0;
    std::uint32_t index = 0;
    std::uint32_t count = 1;  // of elements that belong together; matters for `stratified` alone
    PointSet set = PointSet::sobol;

    /// In [0, 1).
    [[nodiscard]] float next1(Dim dim, std::uint32_t vertex = 0) const;
    /// In [0, 1)².
    [[nodiscard]] Point2 next2(Dim dim, std::uint32_t vertex = 0) const;
    /// Uniform random bits, independent of the samples.
    [[nodiscard]] std::uint32_t bits(Dim dim, std::uint32_t vertex = 0) const {
        return static_cast<std::uint32_t>(hash(dimension_key(dim, vertex), index));
    }

  private:
    [[nodiscard]] std::uint64_t dimension_key(Dim dim, std::uint32_t vertex) const {
        return mix(key ^ dimension_bits(dim, vertex));
    }
};

/// The stream of a camera sample; `x`, `y` are pixels of the full frame.
inline SampleStream pixel_stream(std::uint64_t seed, int x, int y, std::uint32_t sample, std::uint32_t count,
                                 PointSet set) {
    const std::uint64_t pixel =
        static_cast<std::uint64_t>(static_cast<std::uint32_t>(y)) << 32 | static_cast<std::uint32_t>(x);
    return {hash(seed, pixel), sample, count, set};
}

}  // namespace relumine
