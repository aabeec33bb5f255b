// SPDX-License-Identifier: Apache-2.0
// Diffuse surfaces under a dielectric that refracts, and diffuse surfaces that let light through.
#include "shading/bsdf.hpp"
#include "shading/sampling.hpp"

namespace relumine {
namespace {

float transmittance(const CoatedDiffuse& b, LocalDir w) {
    return 1 - fresnel_dielectric(cos_theta(w), b.eta);
}

/// The probability of sampling the coat, by the lobes' rough shares of the reflected light.
float coat_probability(const CoatedDiffuse& b, LocalDir w_out) {
    if (!b.coated) return 0;
    const float through = transmittance(b, w_out), diffuse = 0.9f * through * max_component(b.base);
    if (diffuse <= 0) return 1;
    return std::clamp((1 - through) / (1 - through + diffuse), 0.1f, 0.9f);
}

BsdfValue evaluate(const CoatedDiffuse& b, LocalDir w_out, LocalDir w_in, float coat) {
    if (cos_theta(w_in) <= 0) return {};
    const float diffuse_pdf = cos_theta(w_in) * inv_pi;
    const Spectrum diffuse = b.base * (diffuse_pdf * transmittance(b, w_out) * transmittance(b, w_in));
    if (b.smooth || !b.coated) return {diffuse, (1 - coat) * diffuse_pdf};
    const LocalDir m{normalize(w_out.v + w_in.v)};
    const float density = ggx_density(b.ggx, m);
    const Spectrum specular{fresnel_dielectric(dot(w_in.v, m.v), b.eta) * density
                            * ggx_masking_shadowing(b.ggx, w_out, w_in) / (4 * cos_theta(w_out))};
    return {diffuse + specular, (1 - coat) * diffuse_pdf + coat * reflection_pdf(b.ggx, w_out, density)};
}

/// The probability of sampling reflection.
float reflection_share(const DiffuseTransmission& b) {
    const float r = max_component(b.reflectance), t = max_component(b.transmittance);
    return r + t > 0 ? r / (r + t) : 1.0f;
}

}  // namespace

Spectrum eval(const CoatedDiffuse& b, LocalDir w_out, LocalDir w_in) {
    return evaluate(b, w_out, w_in, 0).value;
}
float pdf(const CoatedDiffuse& b, LocalDir w_out, LocalDir w_in) {
    return evaluate(b, w_out, w_in, coat_probability(b, w_out)).pdf;
}

std::optional<BsdfSample> sample(const CoatedDiffuse& b, LocalDir w_out, BsdfRandom u) {
    const float coat = coat_probability(b, w_out);
    const bool choose_coat = u.lobe < coat;
    if (choose_coat && b.smooth) {
        const Spectrum reflected{fresnel_dielectric(cos_theta(w_out), b.eta)};
        return BsdfSample{{{-w_out.v.x, -w_out.v.y, w_out.v.z}}, reflected / coat, coat, true};
    }
    const LocalDir w_in =
        choose_coat ? sample_reflection(b.ggx, w_out, u.direction) : cosine_hemisphere(u.direction);
    const auto [value, density] = evaluate(b, w_out, w_in, coat);
    if (!(density > 0)) return {};
    return BsdfSample{w_in, value / density, density};
}

float coat_delta_probability(const CoatedDiffuse& b, LocalDir w_out) {
    return b.smooth ? coat_probability(b, w_out) : 0.0f;
}

Spectrum eval(const DiffuseTransmission& b, LocalDir, LocalDir w_in) {
    return (cos_theta(w_in) > 0 ? b.reflectance : b.transmittance) * (std::abs(cos_theta(w_in)) * inv_pi);
}

float pdf(const DiffuseTransmission& b, LocalDir, LocalDir w_in) {
    const float share = reflection_share(b);
    return (cos_theta(w_in) > 0 ? share : 1 - share) * std::abs(cos_theta(w_in)) * inv_pi;
}

std::optional<BsdfSample> sample(const DiffuseTransmission& b, LocalDir w_out, BsdfRandom u) {
    LocalDir w_in = cosine_hemisphere(u.direction);
    if (cos_theta(w_in) <= 0) return {};
    if (!(u.lobe < reflection_share(b))) w_in.v.z = -w_in.v.z;
    const float density = pdf(b, w_out, w_in);
    if (!(density > 0)) return {};
    return BsdfSample{w_in, eval(b, w_out, w_in) / density, density};
}

}  // namespace relumine
