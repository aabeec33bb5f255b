// SPDX-License-Identifier: Apache-2.0
// Rays that pass surfaces.
#include "trace/transparency.hpp"

#include <cmath>

#include "base/hash.hpp"

namespace relumine {
namespace {

constexpr double log2_unit = 0x1p32;
constexpr std::int64_t log2_of_zero = std::int64_t{-2048} << 32;  // too small for any float

std::int64_t fixed_log2(float x) {
    return x > 0 ? std::llround(std::log2(static_cast<double>(x)) * log2_unit) : log2_of_zero;
}

float fixed_exp2(std::int64_t x) { return static_cast<float>(std::exp2(static_cast<double>(x) / log2_unit)); }

/// A hit that Embree asks about.
struct Candidate {
    Hit hit;           // without t
    std::size_t lane;  // of its ray
    float random;      // decides whether the ray sees the surface, in [0, 1)
};

/// Asks `passes(candidate)` for each hit and drops those it is true of.
template <typename Passes>
void filter(const RTCFilterFunctionNArguments* args, const Passes& passes) {
    const auto& query = *reinterpret_cast<const Query*>(args->context);
    const auto& data = *static_cast<const FilterData*>(args->geometryUserPtr);
    for (unsigned i = 0; i < args->N; ++i) {
        if (args->valid[i] == 0) continue;
        Candidate c{{}, RTCRayN_id(args->ray, args->N, i), 0};
        c.hit.u = RTCHitN_u(args->hit, args->N, i);
        c.hit.v = RTCHitN_v(args->hit, args->N, i);
        c.hit.triangle = RTCHitN_primID(args->hit, args->N, i);
        c.hit.instance =
            data.instance != no_instance ? data.instance : RTCHitN_instID(args->hit, args->N, i, 0);
        const std::uint64_t surface = std::uint64_t{c.hit.instance} << 32 | c.hit.triangle;
        c.random = unit_float(static_cast<std::uint32_t>(hash(surface, query.opacity_seed(c.lane))));
        if (passes(query, data, c)) args->valid[i] = 0;
    }
}

}  // namespace

void PassedLight::multiply(std::size_t lane, Spectrum transmittance) {
    auto& log2 = log2_[lane];
    log2[0] += fixed_log2(transmittance.r);
    log2[1] += fixed_log2(transmittance.g);
    log2[2] += fixed_log2(transmittance.b);
}

Spectrum PassedLight::operator[](std::size_t lane) const {
    const auto& log2 = log2_[lane];
    return {fixed_exp2(log2[0]), fixed_exp2(log2[1]), fixed_exp2(log2[2])};
}

void pass_transparent(const RTCFilterFunctionNArguments* args) {
    filter(args, [](const Query&, const FilterData& data, const Candidate& c) {
        return c.random >= (*data.opacity)(c.hit);
    });
}

void pass_panes(const RTCFilterFunctionNArguments* args) {
    filter(args, [](const Query& query, const FilterData& data, const Candidate& c) {
        return c.random >= 1 - max_component(data.panes->transmittance(c.hit, query.direction(c.lane)));
    });
}

void pass_light(const RTCFilterFunctionNArguments* args) {
    filter(args, [](const Query& query, const FilterData& data, const Candidate& c) {
        const Spectrum passed = data.panes->transmittance(c.hit, query.direction(c.lane));
        const float most = max_component(passed);
        if (query.tints) {
            if (c.random >= 1 - most && most > 0) query.light->multiply(c.lane, passed / most);
            return true;
        }
        if (query.light && most > 0) query.light->multiply(c.lane, passed);
        return most > 0;
    });
}

}  // namespace relumine
