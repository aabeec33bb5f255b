// SPDX-License-Identifier: Apache-2.0
// The BSDF of a receiver, times the cosine, over its square.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "cache/mask.hpp"
#include "radiance/transport.hpp"

namespace relumine {

/// What lies over a base. Each layer takes light from those below; whether it reflects any is another matter:
/// a smooth one's reflection is none of the kernel's.
struct OverLayers {
    float clearcoat = 0, clearcoat_lobe = 0;  // strengths of what the clear coat takes, and reflects
    float clearcoat_alpha = 1;                // GGX
    Masking clearcoat_masking = Masking::correlated;
    float sheen = 0;  // the largest channel of what takes
    Spectrum sheen_lobe;
    float sheen_alpha = 1;
    float eta = 0;  // not 0: a dielectric in place of the base's coat, which the specular lobe is of
};

/// A reflecting BSDF seen from one side, in numbers that a kernel evaluates: a diffuse base under a coat, one
/// GGX lobe, and what may lie over them. Lambert, RoughConductor, MetallicRoughness, CoatedLayers and
/// CoatedDiffuse are such; BSDFs that transmit are not and are gathered by Monte Carlo.
struct ReceiverBsdf {
    Spectrum diffuse;
    Spectrum coat_f0, coat_f90;
    Spectrum specular_f0, specular_f90;
    Ggx ggx;
    bool coated = false, specular = false;
    OverLayers over;
    LocalDir w_out;                        // in the shading frame
    Vec3 shading_x, shading_y, shading_z;  // the shading frame's axes in the receiver's frame
};

/// Whether anything lies over the base.
inline bool is_layered(const ReceiverBsdf& b) {
    return b.over.clearcoat > 0 || b.over.sheen > 0 || b.over.eta > 0;
}
inline bool has_clearcoat_lobe(const ReceiverBsdf& b) { return b.over.clearcoat_lobe > 0; }
inline bool has_sheen_lobe(const ReceiverBsdf& b) { return !is_black(b.over.sheen_lobe); }
inline bool has_ggx_lobe(const ReceiverBsdf& b) { return b.specular || has_clearcoat_lobe(b); }
inline bool has_lobes(const ReceiverBsdf& b) { return has_ggx_lobe(b) || has_sheen_lobe(b); }

/// α of the sharpest GGX lobe; infinite if there is none.
inline float sharpest_alpha(const ReceiverBsdf& b) {
    return std::min(b.specular ? b.ggx.alpha : infinity,
                    has_clearcoat_lobe(b) ? b.over.clearcoat_alpha : infinity);
}

/// The least width of any lobe along any axis, in α of GGX; infinite if there is none. That of sheen is by
/// the curvature of sin^(1/α).
inline float least_width(const ReceiverBsdf& b) {
    return std::min({b.specular ? least_alpha(b.ggx) : infinity,
                     has_clearcoat_lobe(b) ? b.over.clearcoat_alpha : infinity,
                     has_sheen_lobe(b) ? std::sqrt(b.over.sheen_alpha) : infinity});
}

/// The diffuse part alone, with what lies over it.
[[nodiscard]] inline ReceiverBsdf without_lobes(ReceiverBsdf b) {
    b.specular = false;
    b.over.clearcoat_lobe = 0;
    b.over.sheen_lobe = {};
    return b;
}

/// Empty for BSDFs that transmit: their light does not come from the receiver's hemisphere alone.
[[nodiscard]] std::optional<ReceiverBsdf> receiver_bsdf(const Vertex& vertex, const Frame& receiver);

/// Directions in the receiver's frame, one array per axis.
struct Directions {
    std::span<const float> x, y, z;
};
struct SpectrumArrays {
    std::span<float> r, g, b;
};

/// f·|cos θ|, 1/sr, for every direction; 0 below the shading hemisphere. Relative error against
/// eval(const Bsdf&, …): 2e-4, from the half vectors of sharp lobes.
void evaluate(const ReceiverBsdf& bsdf, const Directions& w_in, const SpectrumArrays& out);

/// The same at the centres of some cells of 2 × 2 bits, and wherever it costs nothing. `centers`, `out`:
/// (mask_side/2)².
void evaluate_cells(const ReceiverBsdf& bsdf, const Directions& centers, const CellMask& cells,
                    const SpectrumArrays& out);

/// Σ over tiles of 4 × 4 bits of f·|cos θ| for the tile's direction × Σ over its lit bits of radiance. What
/// is black costs nothing. `radiance`: mask_side², RGBE; `directions`: (mask_side/4)².
[[nodiscard]] Spectrum reflect_tiles(const ReceiverBsdf& bsdf, const Directions& directions,
                                     std::span<const std::uint32_t> radiance, const Mask& lit);

/// Directions in runs of 16 lanes: run i is [16 i, 16 i + 16), one direction for each of 16 texels.
struct DirectionRuns {
    std::vector<float> x, y, z;
};

/// Radiance at the same points.
struct RadianceRuns {
    std::vector<float> r, g, b;
};

/// The means of f·|cos θ| over the points of some tiles' texels, 0 for points below the horizon of `normal`.
/// A tile has `per_texel` runs from run `tile · per_texel` on and receives 16 values.
void evaluate_tiles(const ReceiverBsdf& bsdf, Vec3 normal, const DirectionRuns& points, std::size_t per_texel,
                    std::span<const std::uint32_t> tiles, const SpectrumArrays& out);

/// The same of f·|cos θ| times `radiance`.
void evaluate_products(const ReceiverBsdf& bsdf, Vec3 normal, const DirectionRuns& points,
                       const RadianceRuns& radiance, std::size_t per_texel,
                       std::span<const std::uint32_t> tiles, const SpectrumArrays& out);

}  // namespace relumine
