// SPDX-License-Identifier: Apache-2.0
// Projecting surfels to a receiver's square, as many corners at once as the machine has lanes [V, §3.3].
#pragma once

#include <span>

#include "cache/mask.hpp"
#include "cache/record.hpp"

namespace relumine {

/// How a record's surfels look from a receiver.
struct Projection {
    Frame turn;    // the receiver's axes in the record's frame
    Vec3 shift;    // in the receiver's frame, metres: record's position − receiver's position
    bool rotated;  // the receiver's frame is not the record's; else `turn` is not looked at
    int side;      // texels along each side of the record's texture
};

/// What becomes of surfels in the receiver's square: masks, the bounding rectangles of the projected corners,
/// empty where a surfel cannot be used, and trails, which enclose the mask and the rectangle that the surfel
/// had for the record: its rectangle of texels, moved to where the mean of its corners lies in the receiver's
/// frame. Four more corners would cost a third of the kernel's time and change neither masks nor errors. A
/// bit is covered if its centre is. A projected surfel is not used where it turns its
/// back, where it looks more than `largest_growth` times as wide or high as for the record (its texture says
/// too little then; its trail still keeps others from showing through), and where all of it is below the
/// horizon: its trail is then where it was for the record.
inline constexpr float largest_growth = 2;
inline constexpr float growth_margin = 4;  // bits: small surfels may grow more

/// Projects the surfels [begin, end) to masks[0, end − begin) and trails[0, end − begin); both spans must
/// have room for surfel_padding more. All surfels at infinity or none. The same bits on every machine.
void project_surfels(const Surfels& surfels, std::size_t begin, std::size_t end, const Projection& projection,
                     std::span<BitRect> masks, std::span<BitRect> trails);

}  // namespace relumine
