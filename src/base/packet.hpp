// SPDX-License-Identifier: Apache-2.0
// How many paths, rays and random numbers go side by side.
#pragma once

#include <cstddef>

namespace relumine {

inline constexpr std::size_t packet_size = 16;

}  // namespace relumine
