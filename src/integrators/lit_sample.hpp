// SPDX-License-Identifier: Apache-2.0
// A camera sample on its way from maps to the film, and which samples of a pixel are alike.
#pragma once

#include "integrators/gbuffer.hpp"
#include "integrators/residual_rays.hpp"

namespace relumine {

struct LitSample {
    const GBufferPixel* pixel = nullptr;
    ReceiverBsdf bsdf;        // world space; only where the pixel reflects alone
    SplitRadiance reflected;  // of the maps' radiance
    Spectrum delta;           // of lights without size
    SampledRadiance sampled;  // what residual and shadow rays add
    Spectrum albedo;          // directional
    float deviation = 0;      // that the maps' light may be off by, luminance
    float maps = 0;           // that were blended
    bool done = false;        // has its integral
};

/// Whether the integral for `a` stands for `b` of the same pixel, but for the colour of the diffuse part: the
/// same maps, and lobes that look alike to within much less than their width. `exact`: that colour may differ
/// where there is nothing else alone.
[[nodiscard]] bool shares_integral(const LitSample& a, const LitSample& b, bool exact);

/// Whether a surface reflects otherwise than diffusely.
[[nodiscard]] inline bool has_layers(const ReceiverBsdf& b) { return b.specular || b.coated; }

/// How much more `b` reflects diffusely than `a`, whose integral it shares.
[[nodiscard]] Spectrum diffuse_ratio(const LitSample& a, const LitSample& b);

}  // namespace relumine
