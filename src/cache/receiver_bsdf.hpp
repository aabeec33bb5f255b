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

/// A reflecting BSDF seen from one side, in numbers that a kernel evaluates: a diffuse base under a coat and
/// one GGX lobe. Lambert, RoughConductor and MetallicRoughness are such; CoatedLayers and
/// CoatedDiffuse are not and are gathered by Monte Carlo.
struct ReceiverBsdf {
    Spectrum diffuse;
    Spectrum coat_f0, coat_f90;
    Spectrum specular_f0, specular_f90;
    Ggx ggx;
    bool coated = false, specular = false;
    LocalDir w_out;                        // in the shading frame
    Vec3 shading_x, shading_y, shading_z;  // the shading frame's axes in the receiver's frame
};

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
