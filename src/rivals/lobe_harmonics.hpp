// SPDX-License-Identifier: Apache-2.0
// Reflection as harmonics over incident directions, from a table by view angle [Krivanek05].
#pragma once

#include "rivals/harmonics.hpp"
#include "shading/bsdf.hpp"

namespace relumine {

/// The roughness from which a lobe is smooth enough for so many bands: narrower ones are cut short.
constexpr float least_lobe_alpha(int bands) { return 3.0f / static_cast<float>(bands); }

/// Coefficients of a function of directions, one set per channel.
using SpectralHarmonics = std::array<HarmonicValues, 3>;

/// f·|cos θ| of layered surfaces. GGX lobes are tabulated by roughness and view angle, once for what
/// Schlick's Fresnel multiplies by f0 and once for f90, so one table serves all materials, also textured
/// ones.
class LobeHarmonics {
  public:
    LobeHarmonics(int bands, Masking masking);

    [[nodiscard]] int bands() const { return bands_; }
    /// Of cos θ / π above the horizon.
    [[nodiscard]] const HarmonicValues& cosine() const { return cosine_; }

    /// Of a diffuse surface of this albedo under the lobe of `layers` (not smooth), seen from a direction of
    /// cosine `cos_out` over +x, with z the normal.
    void reflection(Spectrum diffuse, const MetallicRoughness& layers, float cos_out,
                    SpectralHarmonics& out) const;

  private:
    struct Entry {
        HarmonicValues f0, f90;
    };
    void tabulate(Masking masking);

    int bands_;
    std::vector<Entry> entries_;  // cosines × roughnesses
    HarmonicValues cosine_{};
};

}  // namespace relumine
