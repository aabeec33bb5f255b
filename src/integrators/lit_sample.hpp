// SPDX-License-Identifier: Apache-2.0
// A camera sample on its way from maps to the film, and which samples of a pixel are alike.
#pragma once

#include <deque>

#include "base/pixel_rect.hpp"
#include "integrators/gbuffer.hpp"
#include "integrators/light_pilot.hpp"
#include "integrators/residual_rays.hpp"

namespace relumine {

struct LitSample {
    const GBufferPixel* pixel = nullptr;
    ReceiverBsdf bsdf;  // world space; only where the pixel reflects alone; without its sharp lobes
    SampledRadiance* lobes = nullptr;  // what these reflect, of LitCell::lobes; null: there are none
    SplitRadiance reflected;           // of the maps' radiance
    Spectrum delta;                    // of lights without size
    SampledRadiance sampled;           // what residual and shadow rays add
    FoundLight more_light;             // of the second series, until these join `sampled`
    FoundResidual more_residual;
    Spectrum albedo;      // directional
    float deviation = 0;  // that the maps' light may be off by, luminance
    float maps = 0;       // that were blended
    bool done = false;    // has its integral
};

/// The samples of a cell on their way.
struct LitCell {
    PixelRect rect;
    std::size_t per_pixel;
    std::vector<LitSample> samples;     // pixel by pixel, row-major
    std::vector<PilotLight> pilots;     // by pixel
    std::deque<SampledRadiance> lobes;  // of those samples that have sharp ones

    [[nodiscard]] std::span<LitSample> at(int x, int y) {
        const int pixel = (y - rect.y0) * rect.width() + x - rect.x0;
        return std::span(samples).subspan(static_cast<std::size_t>(pixel) * per_pixel, per_pixel);
    }
    [[nodiscard]] ExpectedLight expected(int x, int y) const {
        return expected_light(pilots, rect.width(), x - rect.x0, y - rect.y0);
    }
};

/// Whether the integral for `a` stands for `b` of the same pixel, but for the colour of the diffuse part: the
/// same maps, and lobes that look alike to within much less than their width. `exact`: that colour may differ
/// where there is nothing else alone.
[[nodiscard]] bool shares_integral(const LitSample& a, const LitSample& b, bool exact);

/// Whether samples of two pixels are looked at from where their lobes look alike: an integral that samples of
/// one pixel would share may be shared by them, too.
[[nodiscard]] bool seen_alike(const LitSample& a, const LitSample& b);

/// Whether a surface reflects otherwise than diffusely.
[[nodiscard]] inline bool has_layers(const ReceiverBsdf& b) {
    return b.specular || b.coated || is_layered(b);
}

/// How much more `b` reflects diffusely than `a`, whose integral it shares.
[[nodiscard]] Spectrum diffuse_ratio(const LitSample& a, const LitSample& b);

}  // namespace relumine
