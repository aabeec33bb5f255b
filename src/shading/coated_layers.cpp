// SPDX-License-Identifier: Apache-2.0
// Sheen and a clear coat over the glTF layering.
#include <array>

#include "shading/bsdf.hpp"
#include "shading/coat.hpp"
#include "shading/sampling.hpp"

namespace relumine {
namespace {

float fifth_power(float x) { return sqr(sqr(x)) * x; }

/// What the clear coat reflects of light from everywhere, at most.
float clearcoat_albedo(const CoatedLayers& b, float cosine) {
    return b.clearcoat * (clearcoat_f0 + (1 - clearcoat_f0) * grazing_albedo(cosine, b.clearcoat_ggx.alpha));
}
float clearcoat_transmittance(const CoatedLayers& b, float cosine) { return 1 - clearcoat_albedo(b, cosine); }

float sheen_transmittance(const CoatedLayers& b, float cosine) {
    const float color = max_component(b.sheen);
    return color > 0 ? std::max(1 - color * sheen_albedo(cosine, b.sheen_alpha), 0.0f) : 1.0f;
}

/// Transmittances of what lies over each part, from one direction.
struct Through {
    float clearcoat, sheen, coat;

    [[nodiscard]] float lobes() const { return clearcoat * sheen; }
    [[nodiscard]] float diffuse() const { return clearcoat * sheen * coat; }
};
Through through(const CoatedLayers& b, float cosine) {
    return {clearcoat_transmittance(b, cosine), sheen_transmittance(b, cosine),
            coat_transmittance(b.base, cosine)};
}

float clearcoat_fresnel(const CoatedLayers& b, float cosine) {
    const float strength = b.clearcoat_reflects ? b.clearcoat : 0.0f;
    return strength * (clearcoat_f0 + (1 - clearcoat_f0) * fifth_power(std::clamp(1 - cosine, 0.0f, 1.0f)));
}

/// The probabilities of sampling each part, by their rough shares of the reflected light.
struct Shares {
    float clearcoat, sheen, specular, diffuse;
    float delta;  // of the mirrored direction: those parts together that are smooth
};
Shares shares(const CoatedLayers& b, LocalDir w_out) {
    const float cosine = cos_theta(w_out);
    const Through t = through(b, cosine);
    Shares s{};
    s.clearcoat = clearcoat_fresnel(b, cosine);
    s.sheen = max_component(b.sheen) > 0
                  ? max_component(b.sheen) * sheen_albedo(cosine, b.sheen_alpha) * t.clearcoat
                  : 0.0f;
    s.specular = max_component(schlick(b.base.specular_f0, b.base.specular_f90, cosine)) * t.lobes();
    s.diffuse = 0.9f * max_component(b.base.diffuse) * t.diffuse();
    for (float* share : {&s.clearcoat, &s.sheen, &s.specular, &s.diffuse})
        *share = *share > 0 ? *share + 0.05f : 0.0f;
    const float sum = s.clearcoat + s.sheen + s.specular + s.diffuse;
    if (!(sum > 0)) return {0, 0, 0, 1, 0};
    for (float* share : {&s.clearcoat, &s.sheen, &s.specular, &s.diffuse}) *share /= sum;
    s.delta = (b.clearcoat_smooth ? s.clearcoat : 0.0f) + (b.base.smooth ? s.specular : 0.0f);
    return s;
}

/// D·G / (4 cos θ_out) and the density of sampling it.
struct GgxValue {
    float value, pdf;
};
GgxValue ggx_value(const Ggx& ggx, LocalDir w_out, LocalDir w_in, LocalDir m) {
    const float density = ggx_density(ggx, m);
    return {density * ggx_masking_shadowing(ggx, w_out, w_in) / (4 * cos_theta(w_out)),
            reflection_pdf(ggx, w_out, density)};
}

BsdfValue evaluate(const CoatedLayers& b, LocalDir w_out, LocalDir w_in, const Shares& s) {
    if (cos_theta(w_in) <= 0) return {};
    const LocalDir m{normalize(w_out.v + w_in.v)};
    const float cosine = dot(w_in.v, m.v), diffuse_pdf = cos_theta(w_in) * inv_pi;
    const Through out = through(b, cos_theta(w_out)), in = through(b, cos_theta(w_in));
    BsdfValue sum{b.base.diffuse * (diffuse_pdf * out.diffuse() * in.diffuse()), s.diffuse * diffuse_pdf};
    if (!b.base.smooth) {
        const GgxValue lobe = ggx_value(b.base.ggx, w_out, w_in, m);
        sum.value += schlick(b.base.specular_f0, b.base.specular_f90, cosine)
                     * (lobe.value * std::min(out.lobes(), in.lobes()));
        sum.pdf += s.specular * lobe.pdf;
    }
    if (!is_black(b.sheen)) {
        const float lobe = sheen_lobe(b.sheen_alpha, w_out, w_in) * cos_theta(w_in);
        sum.value += b.sheen * (lobe * std::min(out.clearcoat, in.clearcoat));
        sum.pdf += s.sheen * 0.5f * inv_pi;
    }
    if (!b.clearcoat_smooth && b.clearcoat > 0) {
        const GgxValue lobe = ggx_value(b.clearcoat_ggx, w_out, w_in, m);
        sum.value += Spectrum{clearcoat_fresnel(b, cosine) * lobe.value};
        sum.pdf += s.clearcoat * lobe.pdf;
    }
    return sum;
}

/// What the smooth parts reflect to the mirrored direction.
Spectrum mirrored(const CoatedLayers& b, LocalDir w_out) {
    const float cosine = cos_theta(w_out);
    Spectrum sum;
    if (b.clearcoat_smooth) sum += Spectrum{clearcoat_fresnel(b, cosine)};
    if (b.base.smooth)
        sum += schlick(b.base.specular_f0, b.base.specular_f90, cosine) * through(b, cosine).lobes();
    return sum;
}

/// Uniform over the hemisphere.
LocalDir uniform_hemisphere(Point2 u) {
    const auto [sine, cosine] = sine_cosine_of_turns(u.x);
    const float z = 1 - u.y, r = std::sqrt(std::max(0.0f, 1 - sqr(z)));
    return {{r * cosine, r * sine, z}};
}

LocalDir sample_part(const CoatedLayers& b, LocalDir w_out, const Shares& s, BsdfRandom u) {
    float beyond = u.lobe - s.delta;
    if (!b.clearcoat_smooth && (beyond -= s.clearcoat) < 0)
        return sample_reflection(b.clearcoat_ggx, w_out, u.direction);
    if (!b.base.smooth && (beyond -= s.specular) < 0)
        return sample_reflection(b.base.ggx, w_out, u.direction);
    if ((beyond -= s.sheen) < 0) return uniform_hemisphere(u.direction);
    return cosine_hemisphere(u.direction);
}

/// ∫ f(cos θ) cos θ / π dω, by Gauss's rule of eight points over the cosine.
template <typename Function>
float hemisphere_mean(const Function& f) {
    constexpr std::array<float, 4> at{0.1834346424956498f, 0.5255324099163290f, 0.7966664774136267f,
                                      0.9602898564975363f};
    constexpr std::array<float, 4> weight{0.3626837833783620f, 0.3137066458778873f, 0.2223810344533745f,
                                          0.1012285362903763f};
    float sum = 0;
    for (std::size_t i = 0; i < at.size(); ++i)
        for (const float sign : {-1.0f, 1.0f}) {
            const float cosine = 0.5f * (1 + sign * at[i]);
            sum += weight[i] * cosine * f(cosine);
        }
    return sum;
}

/// Of the diffuse base's light from everywhere.
float mean_transmittance(const CoatedLayers& b) {
    return hemisphere_mean([&](float cosine) { return through(b, cosine).diffuse(); });
}

}  // namespace

BsdfValue evaluate(const CoatedLayers& b, LocalDir w_out, LocalDir w_in) {
    return evaluate(b, w_out, w_in, shares(b, w_out));
}
Spectrum eval(const CoatedLayers& b, LocalDir w_out, LocalDir w_in) {
    return evaluate(b, w_out, w_in, Shares{}).value;
}
float pdf(const CoatedLayers& b, LocalDir w_out, LocalDir w_in) { return evaluate(b, w_out, w_in).pdf; }

std::optional<BsdfSample> sample(const CoatedLayers& b, LocalDir w_out, BsdfRandom u) {
    const Shares s = shares(b, w_out);
    if (u.lobe < s.delta)
        return BsdfSample{{{-w_out.v.x, -w_out.v.y, w_out.v.z}}, mirrored(b, w_out) / s.delta, s.delta, true};
    const LocalDir w_in = sample_part(b, w_out, s, u);
    const auto [value, density] = evaluate(b, w_out, w_in, s);
    if (!(density > 0)) return {};
    return BsdfSample{w_in, value / density, density};
}

float coat_delta_probability(const CoatedLayers& b, LocalDir w_out) { return shares(b, w_out).delta; }

CoatedLayers without_coat_delta(const CoatedLayers& b) {
    CoatedLayers rest = b;  // smooth lobes stay marked as such, and so no part of eval and pdf
    if (b.base.smooth) rest.base.specular_f0 = rest.base.specular_f90 = Spectrum{};
    rest.clearcoat_reflects = b.clearcoat_reflects && !b.clearcoat_smooth;
    return rest;
}

CoatedAlbedos coated_albedos(const CoatedLayers& b, LocalDir w_out) {
    const Through t = through(b, cos_theta(w_out));
    const float sheen = is_black(b.sheen) ? 0.0f : sheen_albedo(cos_theta(w_out), b.sheen_alpha);
    return {b.base.diffuse * (t.diffuse() * mean_transmittance(b)), b.sheen * (sheen * t.clearcoat),
            t.lobes()};
}

CoatedLayers layered(CoatedLayers layers) {
    layers.base.diffuse = layers.base.diffuse / std::max(mean_transmittance(layers), 1e-3f);
    return layers;
}

float mean_coat_transmittance(Spectrum coat_f0, Spectrum coat_f90, const Ggx& ggx) {
    MetallicRoughness coat;
    coat.coat_f0 = coat_f0;
    coat.coat_f90 = coat_f90;
    coat.ggx = ggx;
    return hemisphere_mean([&](float cosine) { return coat_transmittance(coat, cosine); });
}

}  // namespace relumine
