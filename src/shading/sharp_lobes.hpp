// SPDX-License-Identifier: Apache-2.0
// Taking lobes that are too sharp for a method out of a BSDF.
#pragma once

#include "shading/bsdf.hpp"

namespace relumine {

/// A BSDF in two: what stays is a model of its own, and what was taken out is the difference to it.
struct SharpLobes {
    Bsdf rest;   // black where nothing stays
    Bsdf drawn;  // to sample the lobes by; its pdf is theirs, its value is not
};

/// Takes out the lobes of GGX α (the geometric mean of both) below `alpha` that are no deltas; empty where
/// there is none. Of BSDFs that transmit nothing is taken.
[[nodiscard]] std::optional<SharpLobes> sharp_lobes(const Bsdf& bsdf, float alpha);

/// What the lobes that were taken out of `bsdf` reflect, and the density with which they are sampled.
[[nodiscard]] BsdfValue evaluate(const SharpLobes& lobes, const Bsdf& bsdf, LocalDir w_out, LocalDir w_in);

/// Whether a BSDF reflects nothing because all of it was taken out.
[[nodiscard]] inline bool is_black(const Bsdf& rest) {
    const auto* lambert = std::get_if<Lambert>(&rest);
    return lambert && is_black(lambert->albedo);
}

}  // namespace relumine
