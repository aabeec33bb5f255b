// SPDX-License-Identifier: Apache-2.0
// Amounts of memory.
#pragma once

#include <cstdint>
#include <limits>

namespace relumine {

/// Bytes, where as many may be used as are wanted.
inline constexpr std::uint64_t no_limit = std::numeric_limits<std::uint64_t>::max();

}  // namespace relumine
