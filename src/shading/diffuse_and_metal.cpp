// SPDX-License-Identifier: Apache-2.0
// Lambert, mirror, rough conductor.
#include "shading/bsdf.hpp"
#include "shading/sampling.hpp"

namespace relumine {

Spectrum eval(const Lambert& b, LocalDir, LocalDir w_in) {
    return cos_theta(w_in) > 0 ? b.albedo * (inv_pi * cos_theta(w_in)) : Spectrum{};
}

float pdf(const Lambert&, LocalDir, LocalDir w_in) { return std::max(0.0f, cos_theta(w_in)) * inv_pi; }

std::optional<BsdfSample> sample(const Lambert& b, LocalDir, BsdfRandom u) {
    const LocalDir w_in = cosine_hemisphere(u.direction);
    if (cos_theta(w_in) <= 0) return {};
    return BsdfSample{w_in, b.albedo, cos_theta(w_in) * inv_pi};
}

Spectrum eval(const Mirror&, LocalDir, LocalDir) { return {}; }
float pdf(const Mirror&, LocalDir, LocalDir) { return 0; }

std::optional<BsdfSample> sample(const Mirror& b, LocalDir w_out, BsdfRandom) {
    return BsdfSample{
        {{-w_out.v.x, -w_out.v.y, w_out.v.z}}, schlick(b.f0, Spectrum{1}, cos_theta(w_out)), 1, true};
}

BsdfValue evaluate(const RoughConductor& b, LocalDir w_out, LocalDir w_in) {
    if (cos_theta(w_in) <= 0) return {};
    const LocalDir m{normalize(w_out.v + w_in.v)};
    const float density = ggx_density(b.ggx, m);
    return {schlick(b.f0, Spectrum{1}, dot(w_in.v, m.v))
                * (density * ggx_masking_shadowing(b.ggx, w_out, w_in) / (4 * cos_theta(w_out))),
            reflection_pdf(b.ggx, w_out, density)};
}

Spectrum eval(const RoughConductor& b, LocalDir w_out, LocalDir w_in) {
    return evaluate(b, w_out, w_in).value;
}
float pdf(const RoughConductor& b, LocalDir w_out, LocalDir w_in) { return evaluate(b, w_out, w_in).pdf; }

std::optional<BsdfSample> sample(const RoughConductor& b, LocalDir w_out, BsdfRandom u) {
    const LocalDir w_in = sample_reflection(b.ggx, w_out, u.direction);
    const auto [value, density] = evaluate(b, w_out, w_in);
    if (!(density > 0)) return {};
    return BsdfSample{w_in, value / density, density};
}

}  // namespace relumine
