// SPDX-License-Identifier: Apache-2.0
// The random numbers of many rays from one shading point.
#pragma once

#include "base/sample_stream.hpp"

namespace relumine {

/// The stream of ray `i` of `rays` from the shading point of a camera sample; `purpose` keeps sets of rays
/// apart. Sobol points are one sequence over all camera samples of the pixel.
[[nodiscard]] SampleStream gather_stream(const SampleStream& sample, std::uint64_t purpose, std::uint32_t i,
                                         std::uint32_t rays);

/// The direction's random numbers. A square number of stratified rays fills the n × n strata in blocks of 4 ×
/// 4, so that the rays of a packet are neighbours.
[[nodiscard]] Point2 direction_numbers(const SampleStream& stream, std::uint32_t depth);

}  // namespace relumine
