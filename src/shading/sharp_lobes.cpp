// SPDX-License-Identifier: Apache-2.0
// Which parts of the models are lobes.
#include "shading/sharp_lobes.hpp"

namespace relumine {
namespace {

struct Taken {
    float alpha;  // lobes below it are taken

    using Lobes = std::optional<SharpLobes>;

    Lobes operator()(const RoughConductor& b) const {
        if (b.ggx.alpha >= alpha) return {};
        return SharpLobes{Lambert{}, b};
    }
    Lobes operator()(const MetallicRoughness& b) const {
        if (!takes(b)) return {};
        MetallicRoughness rest = b, drawn = b;
        rest.specular_f0 = rest.specular_f90 = Spectrum{};
        drawn.diffuse = Spectrum{};
        return SharpLobes{is_black(b.diffuse) ? Bsdf{Lambert{}} : Bsdf{rest}, drawn};
    }
    Lobes operator()(const CoatedDiffuse& b) const {
        if (b.smooth || !b.coated || b.ggx.alpha >= alpha) return {};
        CoatedDiffuse rest = b, drawn = b;
        rest.coated = false;
        drawn.base = Spectrum{};
        return SharpLobes{is_black(b.base) ? Bsdf{Lambert{}} : Bsdf{rest}, drawn};
    }
    Lobes operator()(const CoatedLayers& b) const {
        const bool base = takes(b.base), clearcoat = takes_clearcoat(b);
        if (!base && !clearcoat) return {};
        CoatedLayers rest = b, drawn = b;
        if (base) rest.base.specular_f0 = rest.base.specular_f90 = Spectrum{};
        if (clearcoat) rest.clearcoat_reflects = false;
        drawn.base.diffuse = drawn.sheen = Spectrum{};
        if (!base) drawn.base.specular_f0 = drawn.base.specular_f90 = Spectrum{};
        if (!clearcoat) drawn.clearcoat_reflects = false;
        return SharpLobes{reflects(rest) ? Bsdf{rest} : Bsdf{Lambert{}}, drawn};
    }
    Lobes operator()(const auto&) const { return {}; }

    [[nodiscard]] bool takes(const MetallicRoughness& b) const {
        return !b.smooth && b.ggx.alpha < alpha && !(is_black(b.specular_f0) && is_black(b.specular_f90));
    }
    [[nodiscard]] bool takes_clearcoat(const CoatedLayers& b) const {
        return !b.clearcoat_smooth && b.clearcoat_reflects && b.clearcoat > 0
               && b.clearcoat_ggx.alpha < alpha;
    }
    [[nodiscard]] static bool reflects(const CoatedLayers& b) {
        return !is_black(b.base.diffuse) || !is_black(b.sheen) || !is_black(b.base.specular_f0)
               || !is_black(b.base.specular_f90)
               || (b.clearcoat_reflects && !b.clearcoat_smooth && b.clearcoat > 0);
    }
};

}  // namespace

std::optional<SharpLobes> sharp_lobes(const Bsdf& bsdf, float alpha) {
    return std::visit(Taken{alpha}, bsdf);
}

BsdfValue evaluate(const SharpLobes& lobes, const Bsdf& bsdf, LocalDir w_out, LocalDir w_in) {
    const Spectrum all = eval(bsdf, w_out, w_in), rest = eval(lobes.rest, w_out, w_in);
    const Spectrum taken = all - rest;  // rounding may leave less than nothing far from the lobes
    return {{std::max(taken.r, 0.0f), std::max(taken.g, 0.0f), std::max(taken.b, 0.0f)},
            pdf(lobes.drawn, w_out, w_in)};
}

}  // namespace relumine
