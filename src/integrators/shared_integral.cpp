// SPDX-License-Identifier: Apache-2.0
// Integrating once for many.
#include "integrators/shared_integral.hpp"

namespace relumine {

void SharedIntegral::run(const LitSample& first, const Blend& blend) {
    first_ = &first;
    blend_ = blend;
    integral_.run(blend, first.bsdf, first.pixel->cache.gather.frame.n);
    has_matte_ = false;
    if (needs_.deviation || needs_.distribution) {
        integral_.estimate_deviations();
        deviation_ = integral_.deviation();
    }
    if (needs_.distribution) distribution_.build(integral_);
}

Spectrum SharedIntegral::give(LitSample& sample) {
    const Spectrum scale = diffuse_ratio(*first_, sample);
    const bool layered = has_layers(first_->bsdf);
    if (layered && !(scale == Spectrum{1})) {
        give_recoloured(scale, sample);
    } else {
        const MapRadiance all = integral_.reflected();
        sample.reflected = {{}, scale * all.direct, scale * all.indirect};
        sample.albedo = scale * integral_.albedo();
    }
    sample.maps = static_cast<float>(blend_.maps().size());
    if (needs_.deviation) sample.deviation = luminance(scale) * deviation_;
    return layered ? Spectrum{1} : scale;
}

/// The diffuse part under layers, multiplied by `scale`, is an integral of its own.
void SharedIntegral::give_recoloured(Spectrum scale, LitSample& sample) {
    if (!has_matte_) {
        ReceiverBsdf matte = first_->bsdf;
        matte.specular = false;
        matte_.run(blend_, matte, first_->pixel->cache.gather.frame.n);
        has_matte_ = true;
    }
    const auto scaled = [&](Spectrum whole, Spectrum part) { return whole + (scale - Spectrum{1}) * part; };
    const MapRadiance all = integral_.reflected(), part = matte_.reflected();
    sample.reflected = {{}, scaled(all.direct, part.direct), scaled(all.indirect, part.indirect)};
    sample.albedo = scaled(integral_.albedo(), matte_.albedo());
}

}  // namespace relumine
