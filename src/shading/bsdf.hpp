// SPDX-License-Identifier: Apache-2.0
// How surfaces scatter light: a closed set of models, each with sample, eval and pdf of one convention.
//
// Directions are local, unit and point away from the surface; w_out has z > 0: the frame's normal is on the
// viewer's side. eval and pdf describe what is not a delta lobe; delta lobes are met by sample alone.
#pragma once

#include <optional>
#include <variant>

#include "shading/ggx.hpp"

namespace relumine {

struct BsdfSample {
    LocalDir w_in;
    Spectrum weight;     // f·|cos θ| / pdf, dimensionless; may exceed 1
    float pdf = 0;       // per steradian; of delta lobes: the probability of the lobe
    bool delta = false;  // pdf is a probability, and no other strategy finds this direction
    float eta = 1;       // index of refraction on w_in's side over the one on w_out's side
};

struct BsdfRandom {
    float lobe;        // in [0, 1)
    Point2 direction;  // in [0, 1)²
};

/// Diffuse reflection.
struct Lambert {
    Spectrum albedo;
};

/// A perfectly smooth conductor, Fresnel by Schlick.
struct Mirror {
    Spectrum f0;
};

/// A conductor of GGX roughness, Fresnel by Schlick, single scattering.
struct RoughConductor {
    Spectrum f0;
    Ggx ggx;
};

/// Smooth glass: the boundary of a solid body, or a thin sheet with all its internal reflections, which does
/// not bend light.
struct SmoothDielectric {
    float eta = 1.5f;  // index of refraction on the other side over the one on the viewer's side
    Spectrum tint{1};  // of transmitted light
    bool thin = false;
};

/// Glass of GGX roughness [Walter07]; `thin` mirrors the reflected lobe to the other side.
struct RoughDielectric {
    float eta = 1.5f;
    Spectrum tint{1};
    bool thin = false;
    Ggx ggx;
};

/// glTF's opaque layering: a dielectric coat over a diffuse base, mixed with a metal of the same roughness
/// [glTF 2.0, appendix B], where the coat lets T(w_out) · T(w_in) / mean T of the base's light pass, so that
/// all together reflect no more than arrives.
struct MetallicRoughness {
    Spectrum diffuse;                    // albedo under the coat over mean_coat_transmittance
    Spectrum coat_f0, coat_f90;          // of the coat: what it reflects, the base does not get
    Spectrum specular_f0, specular_f90;  // of coat and metal together, weighted
    Ggx ggx;
    bool smooth = false;  // the specular lobe is a delta
};

/// A diffuse base under a dielectric coat that refracts light on its way in and out: what pbrt's
/// "coateddiffuse" tends to where its coat is smooth.
struct CoatedDiffuse {
    Spectrum
        base;  // reflected light over the light that the coat lets in, times what it lets out: f·π / (T·T)
    float eta = 1.5f;  // index of refraction of the coat
    Ggx ggx;
    bool smooth = false;  // the coat's reflection is a delta
    bool coated = true;   // false: the base's light alone
};

/// The layering under sheen, and both under a clear coat [KHR_materials_sheen, KHR_materials_clearcoat]. What
/// a layer reflects, those below do not get: their lobes have the lesser of its transmittances towards w_out
/// and w_in, the diffuse base the product of both.
struct CoatedLayers {
    MetallicRoughness
        base;             // `diffuse` is the albedo over the mean transmittance of all layers: see layered()
    float clearcoat = 0;  // [0, 1], of a coat of index 1.5
    Ggx clearcoat_ggx;
    bool clearcoat_smooth = false;   // the clear coat's reflection is a delta
    bool clearcoat_reflects = true;  // false: it is there for what it takes alone
    Spectrum sheen;                  // colour; black: none
    float sheen_alpha = 1;           // in [least_sheen_alpha, 1]
};

/// Diffuse reflection, and diffuse transmission to the other side.
struct DiffuseTransmission {
    Spectrum reflectance, transmittance;
};

/// What a BSDF says of one direction: eval and pdf, which share most of their work.
struct BsdfValue {
    Spectrum value;  // f·|cos θ|, 1/sr
    float pdf = 0;   // 1/sr
};

using Bsdf = std::variant<Lambert, Mirror, RoughConductor, SmoothDielectric, RoughDielectric,
                          MetallicRoughness, CoatedDiffuse, DiffuseTransmission, CoatedLayers>;

#define RELUMINE_DECLARE_BSDF(Model)                                                                  \
    [[nodiscard]] Spectrum eval(const Model&, LocalDir w_out, LocalDir w_in); /* f·|cos θ|, 1/sr */ \
    [[nodiscard]] float pdf(const Model&, LocalDir w_out,                                             \
                            LocalDir w_in); /* 1/sr; 0 where sample never goes */                     \
    [[nodiscard]] std::optional<BsdfSample> sample(const Model&, LocalDir w_out,                      \
                                                   BsdfRandom u); /* empty: absorbed */

RELUMINE_DECLARE_BSDF(Lambert)
RELUMINE_DECLARE_BSDF(Mirror)
RELUMINE_DECLARE_BSDF(RoughConductor)
RELUMINE_DECLARE_BSDF(SmoothDielectric)
RELUMINE_DECLARE_BSDF(RoughDielectric)
RELUMINE_DECLARE_BSDF(MetallicRoughness)
RELUMINE_DECLARE_BSDF(CoatedDiffuse)
RELUMINE_DECLARE_BSDF(DiffuseTransmission)
RELUMINE_DECLARE_BSDF(CoatedLayers)
#undef RELUMINE_DECLARE_BSDF

/// Both of a model's functions, in one where that saves work.
template <typename Model>
BsdfValue evaluate(const Model& b, LocalDir w_out, LocalDir w_in) {
    return {eval(b, w_out, w_in), pdf(b, w_out, w_in)};
}
inline BsdfValue evaluate(const Lambert& b, LocalDir, LocalDir w_in) {
    const float density = std::max(0.0f, cos_theta(w_in)) * inv_pi;
    return {b.albedo * density, density};
}
[[nodiscard]] BsdfValue evaluate(const RoughConductor& b, LocalDir w_out, LocalDir w_in);
[[nodiscard]] BsdfValue evaluate(const MetallicRoughness& b, LocalDir w_out, LocalDir w_in);

inline Spectrum eval(const Bsdf& bsdf, LocalDir w_out, LocalDir w_in) {
    return std::visit([&](const auto& b) { return eval(b, w_out, w_in); }, bsdf);
}
inline float pdf(const Bsdf& bsdf, LocalDir w_out, LocalDir w_in) {
    return std::visit([&](const auto& b) { return pdf(b, w_out, w_in); }, bsdf);
}
inline BsdfValue evaluate(const Bsdf& bsdf, LocalDir w_out, LocalDir w_in) {
    if (const auto* lambert = std::get_if<Lambert>(&bsdf)) return evaluate(*lambert, w_out, w_in);
    return std::visit([&](const auto& b) { return evaluate(b, w_out, w_in); }, bsdf);
}
inline std::optional<BsdfSample> sample(const Bsdf& bsdf, LocalDir w_out, BsdfRandom u) {
    if (const auto* lambert = std::get_if<Lambert>(&bsdf)) return sample(*lambert, w_out, u);
    return std::visit([&](const auto& b) { return sample(b, w_out, u); }, bsdf);
}

/// Whether the BSDF is nothing but delta lobes, so that light sampling finds nothing.
inline bool is_delta(const Bsdf& bsdf) {
    return std::holds_alternative<Mirror>(bsdf) || std::holds_alternative<SmoothDielectric>(bsdf);
}

/// Whether `sample` chooses between lobes, and so looks at BsdfRandom::lobe.
inline bool has_lobes(const Bsdf& bsdf) {
    return !std::holds_alternative<Lambert>(bsdf) && !std::holds_alternative<RoughConductor>(bsdf);
}

/// The probability with which `sample` draws a delta lobe of a BSDF that may have others.
[[nodiscard]] float delta_probability(const Bsdf& bsdf, LocalDir w_out);

/// The same of a coat.
[[nodiscard]] float coat_delta_probability(const CoatedDiffuse& bsdf, LocalDir w_out);
[[nodiscard]] float coat_delta_probability(const CoatedLayers& bsdf, LocalDir w_out);

/// What is left of a BSDF that is not all delta when its delta lobe is taken away.
[[nodiscard]] Bsdf without_delta(const Bsdf& bsdf);
[[nodiscard]] CoatedLayers without_coat_delta(const CoatedLayers& bsdf);

/// ∫ T cos θ / π dω: what the coat lets pass of light from everywhere.
[[nodiscard]] float mean_coat_transmittance(Spectrum coat_f0, Spectrum coat_f90, const Ggx& ggx);

/// `layers`, whose `base.diffuse` is still an albedo, with that over the mean transmittance of all layers
/// above it.
[[nodiscard]] CoatedLayers layered(CoatedLayers layers);

/// An approximation of the share of light that is reflected or transmitted at normal incidence, for the
/// albedo layer.
[[nodiscard]] Spectrum albedo(const Bsdf& bsdf);

/// Fresnel reflectance of unpolarised light at a dielectric; `eta` as above, `cosine` ≥ 0 on the incident
/// side.
[[nodiscard]] float fresnel_dielectric(float cosine, float eta);

/// The same of a thin sheet with all its internal reflections.
[[nodiscard]] float sheet_reflectance(float cosine, float eta);

}  // namespace relumine
