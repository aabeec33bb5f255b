// SPDX-License-Identifier: Apache-2.0
// Smooth and rough dielectrics, solid or thin.
#include <cmath>

#include "shading/bsdf.hpp"

namespace relumine {
namespace {

float reflectance(float cosine, float eta, bool thin) {
    return thin ? sheet_reflectance(cosine, eta) : fresnel_dielectric(cosine, eta);
}

/// `w_out` refracted at a facet of normal `m` (on w_out's side); empty at total internal reflection.
std::optional<LocalDir> refract(LocalDir w_out, LocalDir m, float eta) {
    const float cos_out = dot(w_out.v, m.v);
    const float sin2_in = std::max(0.0f, 1 - sqr(cos_out)) / sqr(eta);
    if (sin2_in >= 1) return {};
    const float cos_in = std::sqrt(1 - sin2_in);
    return LocalDir{normalize(-w_out.v / eta + m.v * (cos_out / eta - cos_in))};
}

LocalDir through(LocalDir w) { return {{w.v.x, w.v.y, -w.v.z}}; }

/// dω_m / dω_in of refraction [Walter07, eq. 17].
float refraction_jacobian(float cos_out, float cos_in, float eta) {
    return sqr(eta) * std::abs(cos_in) / sqr(cos_out + eta * cos_in);
}

/// The facet normal that takes light from w_in to w_out by refraction, if there is one.
std::optional<LocalDir> refracting_facet(const RoughDielectric& b, LocalDir w_out, LocalDir w_in) {
    if (cos_theta(w_in) >= 0) return {};
    const LocalDir m{face_forward(normalize(w_out.v + w_in.v * b.eta), {0, 0, 1})};  // [Walter07, eq. 16]
    if (dot(w_out.v, m.v) <= 0 || dot(w_in.v, m.v) >= 0) return {};
    return m;
}

}  // namespace

float fresnel_dielectric(float cosine, float eta) {
    const float sin2_t = (1 - sqr(std::min(cosine, 1.0f))) / sqr(eta);
    if (sin2_t >= 1) return 1;
    const float cos_t = std::sqrt(1 - sin2_t);
    const float parallel = (eta * cosine - cos_t) / (eta * cosine + cos_t);
    const float perpendicular = (cosine - eta * cos_t) / (cosine + eta * cos_t);
    return 0.5f * (sqr(parallel) + sqr(perpendicular));
}

float sheet_reflectance(float cosine, float eta) {
    const float r = fresnel_dielectric(cosine, std::max(eta, 1 / eta));
    return 2 * r / (1 + r);  // R + T²R / (1 − R²)
}

Spectrum eval(const SmoothDielectric&, LocalDir, LocalDir) { return {}; }
float pdf(const SmoothDielectric&, LocalDir, LocalDir) { return 0; }

std::optional<BsdfSample> sample(const SmoothDielectric& b, LocalDir w_out, BsdfRandom u) {
    const float r = reflectance(cos_theta(w_out), b.eta, b.thin);
    if (u.lobe < r) return BsdfSample{{{-w_out.v.x, -w_out.v.y, w_out.v.z}}, Spectrum{1}, r, true};
    if (b.thin) return BsdfSample{-w_out, b.tint, 1 - r, true};
    const std::optional<LocalDir> w_in = refract(w_out, {{0, 0, 1}}, b.eta);
    if (!w_in) return {};
    return BsdfSample{*w_in, b.tint / sqr(b.eta), 1 - r, true,
                      b.eta};  // radiance scales with the index squared
}

Spectrum eval(const RoughDielectric& b, LocalDir w_out, LocalDir w_in) {
    if (cos_theta(w_in) == 0) return {};
    if (cos_theta(w_in) > 0 || b.thin) {
        const bool reflected = cos_theta(w_in) > 0;
        const LocalDir mirrored = reflected ? w_in : through(w_in);
        const LocalDir m{normalize(w_out.v + mirrored.v)};
        const float r = reflectance(dot(w_out.v, m.v), b.eta, b.thin);
        const Spectrum share = reflected ? Spectrum{r} : b.tint * (1 - r);
        return share
               * (ggx_density(b.ggx, m) * ggx_masking_shadowing(b.ggx, w_out, mirrored)
                  / (4 * cos_theta(w_out)));
    }
    const auto m = refracting_facet(b, w_out, w_in);
    if (!m) return {};
    const float cos_out = dot(w_out.v, m->v), cos_in = dot(w_in.v, m->v);
    const float transmittance = 1 - reflectance(cos_out, b.eta, false);
    const float f = transmittance * ggx_density(b.ggx, *m) * ggx_masking_shadowing(b.ggx, w_out, w_in)
                    * refraction_jacobian(cos_out, cos_in, b.eta) * cos_out / cos_theta(w_out);
    return b.tint * (f / sqr(b.eta));
}

float pdf(const RoughDielectric& b, LocalDir w_out, LocalDir w_in) {
    if (cos_theta(w_in) == 0) return 0;
    if (cos_theta(w_in) > 0 || b.thin) {
        const bool reflected = cos_theta(w_in) > 0;
        const LocalDir m{normalize(w_out.v + (reflected ? w_in : through(w_in)).v)};
        const float cos_out = dot(w_out.v, m.v);
        const float r = reflectance(cos_out, b.eta, b.thin);
        return (reflected ? r : 1 - r) * visible_normal_pdf(b.ggx, w_out, m) / (4 * cos_out);
    }
    const auto m = refracting_facet(b, w_out, w_in);
    if (!m) return 0;
    const float cos_out = dot(w_out.v, m->v), cos_in = dot(w_in.v, m->v);
    return (1 - reflectance(cos_out, b.eta, false)) * visible_normal_pdf(b.ggx, w_out, *m)
           * refraction_jacobian(cos_out, cos_in, b.eta);
}

std::optional<BsdfSample> sample(const RoughDielectric& b, LocalDir w_out, BsdfRandom u) {
    const LocalDir m = sample_visible_normal(b.ggx, w_out, u.direction);
    const float cos_out = dot(w_out.v, m.v);
    if (cos_out <= 0) return {};
    const bool reflected = u.lobe < reflectance(cos_out, b.eta, b.thin);
    std::optional<LocalDir> w_in;
    if (reflected || b.thin) {
        w_in = reflect(w_out, m);
        if (cos_theta(*w_in) <= 0) return {};
        if (!reflected) w_in = through(*w_in);
    } else {
        w_in = refract(w_out, m, b.eta);
        if (!w_in || cos_theta(*w_in) >= 0) return {};
    }
    const float density = pdf(b, w_out, *w_in);
    if (!(density > 0)) return {};
    return BsdfSample{*w_in, eval(b, w_out, *w_in) / density, density, false,
                      reflected || b.thin ? 1 : b.eta};
}

}  // namespace relumine
