// SPDX-License-Identifier: Apache-2.0
// Rectangles of pixels: cutting and growing them.
#pragma once

#include <algorithm>

#include "relumine/image.hpp"

namespace relumine {

inline PixelRect intersection(const PixelRect& a, const PixelRect& b) {
    return {std::max(a.x0, b.x0), std::max(a.y0, b.y0), std::min(a.x1, b.x1), std::min(a.y1, b.y1)};
}

inline PixelRect grown(const PixelRect& r, int border) {
    return {r.x0 - border, r.y0 - border, r.x1 + border, r.y1 + border};
}

/// The smallest rectangle around `r` with borders at multiples of `cell`.
inline PixelRect aligned(const PixelRect& r, int cell) {
    const auto down = [&](int v) { return v >= 0 ? v / cell * cell : -((-v + cell - 1) / cell * cell); };
    return {down(r.x0), down(r.y0), down(r.x1 + cell - 1), down(r.y1 + cell - 1)};
}

inline bool contains(const PixelRect& r, int x, int y) {
    return x >= r.x0 && x < r.x1 && y >= r.y0 && y < r.y1;
}

}  // namespace relumine
