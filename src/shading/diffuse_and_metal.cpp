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

Spectrum eval(const RoughConductor& b, LocalDir w_out, LocalDir w_in) {
    if (cos_theta(w_in) <= 0) return {};
    const LocalDir m{normalize(w_out.v + w_in.v)};
    return schlick(b.f0, Spectrum{1}, dot(w_in.v, m.v))
           * (ggx_density(b.ggx, m) * ggx_masking_shadowing(b.ggx, w_out, w_in) / (4 * cos_theta(w_out)));
}

float pdf(const RoughConductor& b, LocalDir w_out, LocalDir w_in) {
    if (cos_theta(w_in) <= 0) return 0;
    return reflection_pdf(b.ggx, w_out, {normalize(w_out.v + w_in.v)});
}

std::optional<BsdfSample> sample(const RoughConductor& b, LocalDir w_out, BsdfRandom u) {
    const LocalDir w_in = sample_reflection(b.ggx, w_out, u.direction);
    const float density = pdf(b, w_out, w_in);
    if (!(density > 0)) return {};
    return BsdfSample{w_in, eval(b, w_out, w_in) / density, density};
}

}  // namespace relumine
