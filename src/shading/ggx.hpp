// SPDX-License-Identifier: Apache-2.0
// The GGX distribution of microfacet normals: density, masking, and sampling of visible normals.
#pragma once

#include <array>
#include <cstdint>

#include "shading/sampling.hpp"

namespace relumine {

/// How masking towards the viewer and shadowing towards the light go together.
enum class Masking : std::uint8_t {
    correlated /* by height [Heitz14, eq. 99] */,
    separable /* a plain product */
};

/// Roughness below which a surface counts as perfectly smooth.
inline constexpr float smooth_alpha = 1e-3f;

/// Along the axes of the surface's frame α is `alpha` times a stretch, in [smooth_alpha, 1]. Products with a
/// stretch of 1 are exact, so isotropic lobes have the bits of formulas without it.
struct Ggx {
    float alpha = 0.5f;  // the geometric mean of both
    Masking masking = Masking::correlated;
    float stretch_x = 1, stretch_y = 1;  // their product is 1
};

inline bool is_anisotropic(const Ggx& g) { return g.stretch_x != 1; }
inline float alpha_x(const Ggx& g) { return g.alpha * g.stretch_x; }
inline float alpha_y(const Ggx& g) { return g.alpha * g.stretch_y; }
inline float least_alpha(const Ggx& g) { return g.alpha * std::min(g.stretch_x, g.stretch_y); }

/// A lobe by its two roughnesses, which are brought into range.
inline Ggx make_ggx(float alpha_x, float alpha_y, Masking masking) {
    const float x = std::clamp(alpha_x, smooth_alpha, 1.0f), y = std::clamp(alpha_y, smooth_alpha, 1.0f);
    if (x == y) return {x, masking};
    const float mean = std::sqrt(x * y);
    return {mean, masking, x / mean, y / mean};
}

/// The squared length of the surface part of `w` with axes scaled as the lobe's: (α w)² / α².
inline float stretched2(const Ggx& g, LocalDir w) {
    return sqr(g.stretch_x * w.v.x) + sqr(g.stretch_y * w.v.y);
}

/// Density of microfacet normals over projected area, 1/sr; sin² from x and y keeps narrow peaks exact.
inline float ggx_density(const Ggx& g, LocalDir m) {
    const float a2 = sqr(g.alpha);
    return a2 * inv_pi / sqr(a2 * sqr(m.v.z) + sqr(g.stretch_y * m.v.x) + sqr(g.stretch_x * m.v.y));
}

/// Smith's Λ: masked over visible projected area.
inline float ggx_lambda(const Ggx& g, LocalDir w) {
    const float tan2 = stretched2(g, w) / sqr(w.v.z);
    return 0.5f * (std::sqrt(1 + sqr(g.alpha) * tan2) - 1);
}

inline float ggx_masking(const Ggx& g, LocalDir w) { return 1 / (1 + ggx_lambda(g, w)); }

/// Visible and lit share of the microfacets; both directions on the surface's same side or opposite ones.
inline float ggx_masking_shadowing(const Ggx& g, LocalDir w_out, LocalDir w_in) {
    const float lambda_out = ggx_lambda(g, w_out), lambda_in = ggx_lambda(g, w_in);
    return g.masking == Masking::correlated ? 1 / (1 + lambda_out + lambda_in)
                                            : 1 / ((1 + lambda_out) * (1 + lambda_in));
}

/// A point on the unit sphere's cap z ≥ −`lowest`, uniform in solid angle, as the tip of a mirrored view ray
/// [Dupuy23].
inline Vec3 sample_cap(float lowest, Point2 u) {
    const auto [sine, cosine] = sine_cosine_of_turns(u.x);
    const float z = (1 - u.y) * (1 + lowest) - lowest;
    const float r = std::sqrt(std::max(0.0f, 1 - sqr(z)));
    return {r * cosine, r * sine, z};
}

/// `v`, with its surface part scaled by the lobe's roughnesses.
inline Vec3 roughened(const Ggx& g, Vec3 v) { return {alpha_x(g) * v.x, alpha_y(g) * v.y, v.z}; }

/// The facet normal of a point on the cap [Heitz18].
inline LocalDir facet_normal(const Ggx& g, Vec3 m) {
    return {normalize(roughened(g, {m.x, m.y, std::max(m.z, 1e-12f)}))};
}

/// A microfacet normal, by the density of those visible from `w_out` (z > 0) [Heitz18, Dupuy23].
inline LocalDir sample_visible_normal(const Ggx& g, LocalDir w_out, Point2 u) {
    const Vec3 stretched = normalize(roughened(g, w_out.v));
    return facet_normal(g, sample_cap(stretched.z, u) + stretched);
}

/// 1/sr over microfacet normals.
inline float visible_normal_pdf(const Ggx& g, LocalDir w_out, LocalDir m) {
    return ggx_masking(g, w_out) * std::abs(dot(w_out.v, m.v)) * ggx_density(g, m) / std::abs(w_out.v.z);
}

/// The share of the cap that can reflect above the surface [Eto23, eq. 5 and 6]; α ≤ 1.
inline float reflection_bound(const Ggx& g, LocalDir w_out) {
    const float a2 = sqr(least_alpha(g));
    const float s2 = sqr(1 + std::sqrt(sqr(w_out.v.x) + sqr(w_out.v.y)));
    return (1 - a2) * s2 / (s2 + a2 * sqr(w_out.v.z));
}

inline LocalDir reflect(LocalDir w, LocalDir m) { return {m.v * (2 * dot(w.v, m.v)) - w.v}; }

/// A reflected direction by visible normals, with few of those that would end under the surface [Eto23].
inline LocalDir sample_reflection(const Ggx& g, LocalDir w_out, Point2 u) {
    const Vec3 stretched = normalize(roughened(g, w_out.v));
    return reflect(w_out,
                   facet_normal(g, sample_cap(reflection_bound(g, w_out) * stretched.z, u) + stretched));
}

/// 1/sr over reflected directions whose half vector has ggx_density `density` [Eto23, eq. 8].
inline float reflection_pdf(const Ggx& g, LocalDir w_out, float density) {
    const float stretched_length = std::sqrt(sqr(g.alpha) * stretched2(g, w_out) + sqr(w_out.v.z));
    return density / (2 * (reflection_bound(g, w_out) * w_out.v.z + stretched_length));
}

/// How much of Schlick's grazing term, (1 − w·h)⁵, a lobe of roughness `alpha` reflects of light from
/// everywhere: at least that, by at most 0.006 more in the mean. A closed form, so that kernels can use it.
inline float grazing_albedo(float cosine, float alpha) {
    const float x = std::clamp(1 - cosine, 1e-3f, 1.0f), x2 = sqr(x);
    const float flat = std::max(1 - 6 * alpha, 0.0f), steep = 20 * sqr(alpha) / (alpha + 0.02f);
    return std::min(sqr(x2) * x / (flat + steep * x2), 1.0f);
}

/// Roughnesses of isotropic lobes of which at every angle one has no less a grazing albedo than a stretched
/// lobe has from any azimuth, by 0.002 at most; it may have up to 0.4 more at grazing views. The first is the
/// mean.
inline std::array<float, 3> grazing_alphas(const Ggx& g) {
    const float least = least_alpha(g), most = g.alpha * std::max(g.stretch_x, g.stretch_y);
    return {g.alpha, std::max(0.8f * least, 0.06f * most), most};
}

/// The same of any lobe, whatever the azimuth.
inline float grazing_albedo(float cosine, const Ggx& g) {
    if (!is_anisotropic(g)) return grazing_albedo(cosine, g.alpha);
    const auto [mean, sharp, rough] = grazing_alphas(g);
    return std::max(
        {grazing_albedo(cosine, mean), grazing_albedo(cosine, sharp), grazing_albedo(cosine, rough)});
}

/// Schlick's Fresnel reflectance between `f0` at normal and `f90` at grazing incidence.
inline Spectrum schlick(Spectrum f0, Spectrum f90, float cosine) {
    const float x = std::clamp(1 - cosine, 0.0f, 1.0f);
    return f0 + (f90 - f0) * (sqr(sqr(x)) * x);
}

}  // namespace relumine
