// SPDX-License-Identifier: Apache-2.0
// Pictures side by side, for people to look at.
#pragma once

#include <vector>

#include "relumine/image.hpp"

namespace relumine::pictures {

/// What belongs together: old or reference, new, and their difference.
struct Triple {
    Image before, after;
};

/// Rows of triples, magnified: before, after, and the signed difference (red where `after` is brighter),
/// whose full colour is a fifth of the mean of `before`. Every triple is exposed so that its mean is 0.3.
[[nodiscard]] Image sheet_of(const std::vector<Triple>& triples, int columns, int magnification);

}  // namespace relumine::pictures
