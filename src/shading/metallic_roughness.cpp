// SPDX-License-Identifier: Apache-2.0
// The glTF layering of coat, diffuse base and metal.
#include "shading/bsdf.hpp"
#include "shading/coat.hpp"
#include "shading/sampling.hpp"

namespace relumine {
namespace {

/// The probability of sampling the specular lobe, by the lobes' rough shares of the reflected light.
float specular_probability(const MetallicRoughness& b, LocalDir w_out) {
    const float specular = max_component(schlick(b.specular_f0, b.specular_f90, cos_theta(w_out)));
    const float diffuse = max_component(b.diffuse) * coat_transmittance(b, cos_theta(w_out));
    if (specular <= 0) return 0;
    if (diffuse <= 0) return 1;
    return std::clamp(specular / (specular + diffuse), 0.1f, 0.9f);
}

BsdfValue evaluate(const MetallicRoughness& b, LocalDir w_out, LocalDir w_in, float specular_probability) {
    if (cos_theta(w_in) <= 0) return {};
    const LocalDir m{normalize(w_out.v + w_in.v)};
    const float cosine = dot(w_in.v, m.v), diffuse_pdf = cos_theta(w_in) * inv_pi;
    const Spectrum diffuse =
        b.diffuse
        * (diffuse_pdf * coat_transmittance(b, cos_theta(w_out)) * coat_transmittance(b, cos_theta(w_in)));
    if (b.smooth) return {diffuse, (1 - specular_probability) * diffuse_pdf};
    const float density = ggx_density(b.ggx, m);
    const Spectrum specular =
        schlick(b.specular_f0, b.specular_f90, cosine)
        * (density * ggx_masking_shadowing(b.ggx, w_out, w_in) / (4 * cos_theta(w_out)));
    return {diffuse + specular, (1 - specular_probability) * diffuse_pdf
                                    + specular_probability * reflection_pdf(b.ggx, w_out, density)};
}

}  // namespace

BsdfValue evaluate(const MetallicRoughness& b, LocalDir w_out, LocalDir w_in) {
    return evaluate(b, w_out, w_in, specular_probability(b, w_out));
}

Spectrum eval(const MetallicRoughness& b, LocalDir w_out, LocalDir w_in) {
    return evaluate(b, w_out, w_in, 0).value;
}
float pdf(const MetallicRoughness& b, LocalDir w_out, LocalDir w_in) { return evaluate(b, w_out, w_in).pdf; }

std::optional<BsdfSample> sample(const MetallicRoughness& b, LocalDir w_out, BsdfRandom u) {
    const float specular = specular_probability(b, w_out);
    const bool choose_specular = u.lobe < specular;
    if (choose_specular && b.smooth) {
        const Spectrum reflected = schlick(b.specular_f0, b.specular_f90, cos_theta(w_out));
        return BsdfSample{{{-w_out.v.x, -w_out.v.y, w_out.v.z}}, reflected / specular, specular, true};
    }
    const LocalDir w_in =
        choose_specular ? sample_reflection(b.ggx, w_out, u.direction) : cosine_hemisphere(u.direction);
    const auto [value, density] = evaluate(b, w_out, w_in, specular);
    if (!(density > 0)) return {};
    return BsdfSample{w_in, value / density, density};
}

float delta_probability(const Bsdf& bsdf, LocalDir w_out) {
    if (is_delta(bsdf)) return 1;
    if (const auto* coated = std::get_if<CoatedDiffuse>(&bsdf)) return coat_delta_probability(*coated, w_out);
    if (const auto* coated = std::get_if<CoatedLayers>(&bsdf)) return coat_delta_probability(*coated, w_out);
    const auto* layers = std::get_if<MetallicRoughness>(&bsdf);
    return layers && layers->smooth ? specular_probability(*layers, w_out) : 0.0f;
}

Bsdf without_delta(const Bsdf& bsdf) {
    if (const auto* coated = std::get_if<CoatedDiffuse>(&bsdf)) {
        CoatedDiffuse base = *coated;
        base.coated = base.coated && !base.smooth;
        return base;
    }
    if (const auto* coated = std::get_if<CoatedLayers>(&bsdf)) return without_coat_delta(*coated);
    const auto* layers = std::get_if<MetallicRoughness>(&bsdf);
    if (!layers || !layers->smooth) return bsdf;
    MetallicRoughness diffuse = *layers;
    diffuse.specular_f0 = diffuse.specular_f90 = Spectrum{};
    return diffuse;
}

Spectrum albedo(const Bsdf& bsdf) {
    struct Visitor {
        Spectrum operator()(const Lambert& b) const { return b.albedo; }
        Spectrum operator()(const Mirror& b) const { return b.f0; }
        Spectrum operator()(const RoughConductor& b) const { return b.f0; }
        Spectrum operator()(const SmoothDielectric& b) const { return b.tint; }
        Spectrum operator()(const RoughDielectric& b) const { return b.tint; }
        Spectrum operator()(const MetallicRoughness& b) const {
            const float through = coat_transmittance(b, 1);
            return b.diffuse * (through * mean_coat_transmittance(b.coat_f0, b.coat_f90, b.ggx))
                   + b.specular_f0;
        }
        Spectrum operator()(const CoatedDiffuse& b) const {
            const float reflected = b.coated ? fresnel_dielectric(1, b.eta) : 0.0f;
            return b.base * sqr(1 - fresnel_dielectric(1, b.eta)) + Spectrum{reflected};
        }
        Spectrum operator()(const CoatedLayers& b) const {
            const float coat = 0.04f * b.clearcoat;
            return ((*this)(b.base) + b.sheen * sheen_albedo(1, b.sheen_alpha)) * (1 - coat) + Spectrum{coat};
        }
        Spectrum operator()(const DiffuseTransmission& b) const { return b.reflectance + b.transmittance; }
    };
    return std::visit(Visitor{}, bsdf);
}

}  // namespace relumine
