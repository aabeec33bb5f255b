// SPDX-License-Identifier: Apache-2.0
// Integrating once for many.
#include "integrators/shared_integral.hpp"

namespace relumine {
namespace {

constexpr float most_level = 2;  // that maps which share an integral may differ by

}  // namespace

void SharedIntegral::run(const LitSample& first, const Blend& blend) {
    first_ = &first;
    blend_ = blend;
    integral_.run(blend, first.bsdf, first.pixel->cache.gather.frame.n);
    has_matte_ = false;
    reflected_of_.clear();
    if (needs_.deviation || needs_.distribution) {
        integral_.estimate_deviations();
        deviation_ = integral_.deviation();
    }
    if (needs_.distribution) distribution_.build(integral_);
}

float SharedIntegral::level_under(const Blend& other) {
    const float here = reflected_under(blend_), there = reflected_under(other);
    return here > 0 ? std::clamp(there / here, 1 / most_level, most_level) : 1;
}

float SharedIntegral::reflected_under(const Blend& blend) {
    float sum = 0;
    for (const auto& [map, weight] : blend.maps()) {
        auto known = std::ranges::find(reflected_of_, map, &std::pair<const BlockMap*, float>::first);
        if (known == reflected_of_.end())
            known = reflected_of_.insert(known, {map, integral_.reflected_of(*map)});
        sum += weight * known->second;
    }
    return sum;
}

Spectrum SharedIntegral::give(float level, LitSample& sample) {
    const Spectrum scale = diffuse_ratio(*first_, sample);
    const bool layered = has_layers(first_->bsdf);
    if (layered && !(scale == Spectrum{1})) {
        give_recoloured(scale, sample);
    } else {
        const MapRadiance all = integral_.reflected();
        sample.reflected = {{}, scale * all.direct, scale * all.indirect};
        sample.albedo = scale * integral_.albedo();
    }
    sample.reflected.direct *= level;
    sample.reflected.indirect *= level;
    sample.maps = static_cast<float>(blend_.maps().size());
    if (needs_.deviation) sample.deviation = level * luminance(scale) * deviation_;
    return layered ? Spectrum{1} : scale;
}

/// The diffuse part under layers, multiplied by `scale`, is an integral of its own.
void SharedIntegral::give_recoloured(Spectrum scale, LitSample& sample) {
    if (!has_matte_) {
        matte_.run(blend_, without_lobes(first_->bsdf), first_->pixel->cache.gather.frame.n);
        has_matte_ = true;
    }
    const auto scaled = [&](Spectrum whole, Spectrum part) { return whole + (scale - Spectrum{1}) * part; };
    const MapRadiance all = integral_.reflected(), part = matte_.reflected();
    sample.reflected = {{}, scaled(all.direct, part.direct), scaled(all.indirect, part.indirect)};
    sample.albedo = scaled(integral_.albedo(), matte_.albedo());
}

}  // namespace relumine
