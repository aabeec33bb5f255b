// SPDX-License-Identifier: Apache-2.0
// Directional albedos: how much of the light from everywhere a BSDF sends to the viewer, lobe by lobe.
#pragma once

#include "shading/bsdf.hpp"

namespace relumine {

/// A reflecting BSDF in two parts, seen from one direction: what it reflects diffusely, as a number, and its
/// lobes.
struct LobeSplit {
    Spectrum diffuse;           // directional albedo of the diffuse part, [0, 1]
    Spectrum glossy;            // that of the lobes
    std::optional<Bsdf> lobes;  // the BSDF without its diffuse part; empty where there are none
    bool transmits = false;     // glass: `diffuse` and `glossy` are 0, `lobes` is all of it
    float alpha = 0;            // GGX roughness of the lobes, the mean of stretched ones; 0: a delta
};

/// Exact but for the tables' interpolation, an absolute error of 0.005 (0.02 at views below 5°, 0.03 of
/// stretched lobes); where the
/// channels of a coat's reflectance differ by more than a scale, the largest counts.
[[nodiscard]] LobeSplit split_lobes(const Bsdf& bsdf, LocalDir w_out);

/// ∫ D·G / (4 cos θ_out) · {1 − (1 − w_out · h)⁵, (1 − w_out · h)⁵} dω_in: the factors of f0 and f90 in the
/// albedo of a GGX lobe [Karis13].
struct LobeAlbedo {
    float f0, f90;
};
[[nodiscard]] LobeAlbedo lobe_albedo(LocalDir w_out, const Ggx& ggx);

}  // namespace relumine
