// SPDX-License-Identifier: Apache-2.0
// Tables of directional albedos, integrated once.
#include "shading/reflectance.hpp"

#include <array>

#include "shading/coat.hpp"

namespace relumine {
namespace {

constexpr int cosines = 32, roughnesses = 24, strata = 16;
constexpr int stretched_strata = 8;  // of lobes that no table holds

/// Entries stand for cos θ = (i / (cosines − 1))², and for √α in even steps: finer where albedos change.
float cosine_at(int i) { return std::max(sqr(static_cast<float>(i) / (cosines - 1)), 1e-3f); }
float alpha_at(int j) { return std::max(sqr(static_cast<float>(j) / (roughnesses - 1)), smooth_alpha); }

LocalDir view(float cosine) { return {{std::sqrt(1 - sqr(cosine)), 0, cosine}}; }

float fifth_power(float x) { return sqr(sqr(x)) * x; }

template <typename Add>
void over_square(int side, const Add& add) {
    for (int i = 0; i < side; ++i)
        for (int j = 0; j < side; ++j)
            add(Point2{(static_cast<float>(i) + 0.5f) / static_cast<float>(side),
                       (static_cast<float>(j) + 0.5f) / static_cast<float>(side)});
}

LobeAlbedo integrate_lobe(LocalDir w_out, const Ggx& ggx, int side) {
    LobeAlbedo sum{0, 0};
    over_square(side, [&](Point2 u) {
        const LocalDir w_in = sample_reflection(ggx, w_out, u);
        if (cos_theta(w_in) <= 0) return;
        const LocalDir h{normalize(w_out.v + w_in.v)};
        const float density = ggx_density(ggx, h);
        const float weight = density * ggx_masking_shadowing(ggx, w_out, w_in)
                             / (4 * cos_theta(w_out) * reflection_pdf(ggx, w_out, density));
        const float grazing = fifth_power(1 - dot(w_out.v, h.v));
        sum.f0 += weight * (1 - grazing);
        sum.f90 += weight * grazing;
    });
    const float share = 1.0f / static_cast<float>(side * side);
    return {sum.f0 * share, sum.f90 * share};
}

struct Tables {
    std::array<std::array<std::array<LobeAlbedo, roughnesses>, cosines>, 2> lobe{};  // by masking

    Tables() {
        for (int i = 0; i < cosines; ++i) {
            const auto row = static_cast<std::size_t>(i);
            for (const Masking masking : {Masking::correlated, Masking::separable})
                for (int j = 0; j < roughnesses; ++j)
                    lobe[static_cast<std::size_t>(masking)][row][static_cast<std::size_t>(j)] =
                        integrate_lobe(view(cosine_at(i)), {alpha_at(j), masking}, strata);
        }
    }
};

const Tables& tables() {
    static const Tables all;
    return all;
}

/// Where between two entries of a table of `count` the square root of `x` in [0, 1] lies.
struct Place {
    std::size_t entry;
    float beyond;
};
Place place_of(float x, int count) {
    const float at = std::sqrt(std::clamp(x, 0.0f, 1.0f)) * static_cast<float>(count - 1);
    const int entry = std::min(static_cast<int>(at), count - 2);
    return {static_cast<std::size_t>(entry), at - static_cast<float>(entry)};
}

LobeAlbedo mixed(LobeAlbedo a, LobeAlbedo b, float t) { return {lerp(a.f0, b.f0, t), lerp(a.f90, b.f90, t)}; }

/// ∫ T cos θ / π dω over the hemisphere: what a smooth dielectric lets in of light from everywhere.
float mean_transmittance(float eta) {
    constexpr int steps = 16;
    float sum = 0;
    for (int i = 0; i < steps; ++i)
        sum += 1 - fresnel_dielectric(std::sqrt((static_cast<float>(i) + 0.5f) / steps), eta);
    return sum / steps;
}

constexpr float followed_alpha = 0.1f;

struct Splitter {
    LocalDir w_out;

    LobeSplit operator()(const Lambert& b) const { return {b.albedo, {}, {}, false, 0}; }
    LobeSplit operator()(const Mirror& b) const {
        return {{}, schlick(b.f0, Spectrum{1}, cos_theta(w_out)), b, false, 0};
    }
    LobeSplit operator()(const RoughConductor& b) const {
        const LobeAlbedo a = lobe_albedo(w_out, b.ggx);
        return {{}, b.f0 * a.f0 + Spectrum{a.f90}, b, false, b.ggx.alpha};
    }
    LobeSplit operator()(const SmoothDielectric& b) const { return {{}, {}, b, true, 0}; }
    LobeSplit operator()(const RoughDielectric& b) const { return {{}, {}, b, true, b.ggx.alpha}; }
    LobeSplit operator()(const CoatedDiffuse& b) const {
        const float reflected = b.coated ? fresnel_dielectric(cos_theta(w_out), b.eta) : 0;
        const float through = 1 - fresnel_dielectric(cos_theta(w_out), b.eta);
        LobeSplit split{b.base * (through * mean_transmittance(b.eta)), Spectrum{reflected}, {}, false, 0};
        if (!b.coated) return split;
        CoatedDiffuse coat = b;
        coat.base = {};
        split.lobes = coat;
        split.alpha = b.smooth ? 0 : b.ggx.alpha;
        return split;
    }
    LobeSplit operator()(const DiffuseTransmission& b) const {
        // What comes through is followed as a lobe is.
        return {b.reflectance, b.transmittance, DiffuseTransmission{{}, b.transmittance}, false,
                followed_alpha};
    }
    LobeSplit operator()(const MetallicRoughness& b) const {
        const float coat =
            coat_transmittance(b, cos_theta(w_out)) * mean_coat_transmittance(b.coat_f0, b.coat_f90, b.ggx);
        LobeSplit split{b.diffuse * coat, {}, {}, false, 0};
        if (is_black(b.specular_f90) && is_black(b.specular_f0)) return split;
        if (b.smooth) {
            split.glossy = schlick(b.specular_f0, b.specular_f90, cos_theta(w_out));
        } else {
            const LobeAlbedo a = lobe_albedo(w_out, b.ggx);
            split.glossy = b.specular_f0 * a.f0 + b.specular_f90 * a.f90;
            split.alpha = b.ggx.alpha;
        }
        MetallicRoughness lobes = b;
        lobes.diffuse = {};
        split.lobes = lobes;
        return split;
    }
    LobeSplit operator()(const CoatedLayers& b) const {
        const CoatedAlbedos albedos = coated_albedos(b, w_out);
        LobeSplit split{albedos.diffuse, albedos.sheen, {}, false, 1};
        const bool no_specular = is_black(b.base.specular_f0) && is_black(b.base.specular_f90);
        const bool all_smooth = (no_specular || b.base.smooth) && (b.clearcoat <= 0 || b.clearcoat_smooth);
        const LobeSplit base = (*this)(b.base);
        split.glossy += base.glossy * albedos.through;
        if (b.clearcoat > 0 && b.clearcoat_reflects) {
            LobeAlbedo a{1, 0};
            if (b.clearcoat_smooth)
                a = {1 - fifth_power(1 - cos_theta(w_out)), fifth_power(1 - cos_theta(w_out))};
            else
                a = lobe_albedo(w_out, b.clearcoat_ggx);
            split.glossy += Spectrum{b.clearcoat * (0.04f * a.f0 + a.f90)};
            split.alpha = std::min(split.alpha, b.clearcoat_ggx.alpha);
        }
        if (!no_specular) split.alpha = std::min(split.alpha, b.base.ggx.alpha);
        if (is_black(split.glossy)) return split;
        if (all_smooth && is_black(b.sheen)) split.alpha = 0;
        CoatedLayers lobes = b;
        lobes.base.diffuse = {};
        split.lobes = lobes;
        return split;
    }
};

}  // namespace

LobeAlbedo lobe_albedo(LocalDir w_out, const Ggx& ggx) {
    if (is_anisotropic(ggx)) return integrate_lobe(w_out, ggx, stretched_strata);
    const auto& table = tables().lobe[static_cast<std::size_t>(ggx.masking)];
    const Place i = place_of(cos_theta(w_out), cosines), j = place_of(ggx.alpha, roughnesses);
    const auto row = [&](std::size_t k) { return mixed(table[k][j.entry], table[k][j.entry + 1], j.beyond); };
    return mixed(row(i.entry), row(i.entry + 1), i.beyond);
}

LobeSplit split_lobes(const Bsdf& bsdf, LocalDir w_out) { return std::visit(Splitter{w_out}, bsdf); }

}  // namespace relumine
