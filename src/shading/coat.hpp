// SPDX-License-Identifier: Apache-2.0
// What layers over a surface reflect and let pass, by direction.
#pragma once

#include <array>

#include "shading/bsdf.hpp"

namespace relumine {

/// What the coat lets pass of light from `cosine`: no more than its lobe leaves of it, whatever the
/// roughness. The specification's 1 − F at the half vector gains energy: the lobe reflects less than F there
/// and more elsewhere.
inline float coat_transmittance(const MetallicRoughness& b, float cosine) {
    const Spectrum reflected = b.coat_f0 + (b.coat_f90 - b.coat_f0) * grazing_albedo(cosine, b.ggx);
    return 1 - std::min(1.0f, max_component(reflected));
}

inline constexpr float clearcoat_f0 = 0.04f;  // index of refraction 1.5

/// Sheen is no smoother than this: its lobe would be a line along the horizon.
inline constexpr float least_sheen_alpha = 0.01f;

/// Seen from `w_out`: the albedos of the diffuse base and of the sheen, and what reaches the base's lobe.
struct CoatedAlbedos {
    Spectrum diffuse, sheen;
    float through;
};
[[nodiscard]] CoatedAlbedos coated_albedos(const CoatedLayers& b, LocalDir w_out);

/// Directional albedo of white sheen of roughness `alpha`, in [0, 1]; at grazing angles an upper bound.
[[nodiscard]] float sheen_albedo(float cosine, float alpha);

/// D·V of sheen [Estevez17], over the larger of its albedos from both directions where that exceeds 1; 1/sr.
/// Both directions above the surface.
[[nodiscard]] float sheen_lobe(float alpha, LocalDir w_out, LocalDir w_in);

inline constexpr int sheen_cosines = 32;

/// What both of these follow from by cosines, for kernels that evaluate many directions.
struct SheenCurves {
    /// log Λ is a / (1 + b x^c) + d x + e [Estevez17] for cosines x up to ½, and as far above its value there
    /// at 1 − x as below it at x.
    float a, b, c, d, e;
    std::array<float, sheen_cosines> albedo;  // of the lobe as published, over √cos θ in even steps
};
[[nodiscard]] SheenCurves sheen_curves(float alpha);

}  // namespace relumine
