// SPDX-License-Identifier: Apache-2.0
// From a material's factors and textures at a point to the models that scatter and emit light there.
#pragma once

#include <vector>

#include "shading/bsdf.hpp"
#include "shading/surface_point.hpp"

namespace relumine {

/// The BSDF at `p`. Where a material is partly transmissive, `u` in [0, 1) decides whether this is glass or
/// the opaque layering.
[[nodiscard]] Bsdf make_bsdf(const SceneData& scene, const SurfacePoint& p, Masking masking, float u);

/// Thin, smooth glass that emits nothing is a pane: a surface that rays pass by chance and shadow rays
/// always, as the tracer has it. So it is a vertex only for what it does not let pass.
[[nodiscard]] Pane pane_kind(const SceneData& scene, const Mesh& mesh);

/// The share of light that passes the pane at `hit` (field t unset) straight along `direction`; at most 1.
[[nodiscard]] Spectrum pane_transmittance(const SceneData& scene, const Hit& hit, WorldDir direction);

/// The BSDF of a pane for a ray that has not passed; `u` in [0, 1) decides between glass, the opaque layering
/// and what the tint absorbs.
[[nodiscard]] Bsdf make_pane_bsdf(const SceneData& scene, const Hit& hit, const SurfacePoint& p,
                                  LocalDir w_out, Masking masking, float u);

/// The same reflection in the form of the layering: of Lambert, rough conductors and rough layers; empty for
/// others.
[[nodiscard]] std::optional<MetallicRoughness> as_layers(const Bsdf& bsdf);

/// The BSDFs of the materials that are the same everywhere and from both sides, made once.
class UniformBsdfs {
  public:
    UniformBsdfs(const SceneData& scene, Masking masking);

    /// Null where the BSDF depends on the point.
    [[nodiscard]] const Bsdf* find(const SurfacePoint& p) const {
        const auto& bsdf = bsdfs_[static_cast<std::size_t>(p.material - first_)];
        return bsdf && !p.has_vertex_color ? &*bsdf : nullptr;
    }

    /// The same as layers, for surfaces without a normal map whose inside does not attenuate; null for
    /// others.
    [[nodiscard]] const MetallicRoughness* find_layers(MaterialId material) const {
        const auto& layers = layers_[index(material)];
        return layers ? &*layers : nullptr;
    }

  private:
    const Material* first_;
    std::vector<std::optional<Bsdf>> bsdfs_;                // per material
    std::vector<std::optional<MetallicRoughness>> layers_;  // per material
};

/// Radiance that the surface emits towards the viewer of `p`, W·sr⁻¹·m⁻².
[[nodiscard]] Spectrum emitted_radiance(const SceneData& scene, const SurfacePoint& p);

/// As above, at texture coordinates, without regard to sides.
[[nodiscard]] Spectrum material_emission(const SceneData& scene, const Material& material,
                                         const TextureUv& uv);

/// Opacity in [0, 1]: 0 or 1 for alpha masks.
[[nodiscard]] float opacity(const SceneData& scene, const Material& material, const TextureCoordinates& at);

/// The share of light that passes `distance` metres through the body behind this (solid) material.
[[nodiscard]] Spectrum transmittance(const Material& material, float distance);

/// Whether light inside the body behind this material is attenuated.
inline bool attenuates(const Material& material) {
    return material.solid && std::isfinite(material.attenuation_distance);
}

}  // namespace relumine
