// SPDX-License-Identifier: Apache-2.0
// Reprojection: what a record has seen, as it looks from another point, near layer to far and without a
// z-buffer [V, §3.3].
#pragma once

#include "cache/project_kernel.hpp"

namespace relumine {

/// The point that borrows a record's view.
struct Receiver {
    Vec3 position;  // world space
    Frame frame;    // n: geometric normal on the viewer's side
};

/// The receiver's frame that is turned least from a record's: where the normals agree the squares agree, so
/// that light from infinity stays in its bits.
[[nodiscard]] Frame receiver_frame(const Frame& record_frame, Vec3 normal);

/// Incident radiance over the receiver's square, bit by bit. Large: keep one per thread and `clear` it.
struct Reprojection {
    Mask covered;  // bits with radiance
    Mask unknown;  // not covered, and the move from the last record may have opened a view there
    Mask lit;      // those covered bits that may not be black
    std::vector<std::uint32_t>
        radiance;  // mask_side² (+ padding), row-major in (y, x), RGBE; where not lit whatever was there
    std::vector<std::uint32_t>
        direct;       // the part straight from lights; empty where records do not keep it apart
    int records = 0;  // used so far
    int layers = 0;   // of all these records that have covered a bit

    /// Bits without radiance.
    [[nodiscard]] int gaps() const { return mask_bits - covered.count(); }

    void clear(bool with_direct);
    /// Writes 0 where no bit is lit, for those who look at the radiance itself.
    void blacken();

    std::vector<BitRect> masks, trails;  // scratch
};

/// Covers bits that are not covered yet by what `record` saw. The unknown mask begins anew for each record,
/// the covered one is kept, so that records hide each other's surfels rightly.
void reproject(const Record& record, const Receiver& receiver, Reprojection& out);

}  // namespace relumine
