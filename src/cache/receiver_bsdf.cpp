// SPDX-License-Identifier: Apache-2.0
// Bringing BSDFs to one form.
#include "cache/receiver_bsdf.hpp"

namespace relumine {
namespace {

struct Lobes {
    ReceiverBsdf bsdf;
    bool reflects_alone = true;

    void operator()(const Lambert& b) { bsdf.diffuse = b.albedo; }
    void operator()(const RoughConductor& b) { set_specular(b.f0, Spectrum{1}, b.ggx); }
    void operator()(const MetallicRoughness& b) {
        bsdf.diffuse = b.diffuse;
        bsdf.coat_f0 = b.coat_f0;
        bsdf.coat_f90 = b.coat_f90;
        bsdf.coated = !is_black(b.coat_f0) || !is_black(b.coat_f90);
        bsdf.ggx = b.ggx;  // which the coat's share depends on
        if (!b.smooth) set_specular(b.specular_f0, b.specular_f90, b.ggx);
    }
    void operator()(const CoatedDiffuse& b) {
        bsdf.diffuse = b.base;
        bsdf.over.eta = b.eta;
        if (b.coated && !b.smooth) set_specular(Spectrum{1}, Spectrum{1}, b.ggx);
    }
    void operator()(const CoatedLayers& b) {
        (*this)(b.base);
        OverLayers& over = bsdf.over;
        over.clearcoat = b.clearcoat;
        over.clearcoat_lobe = b.clearcoat_reflects && !b.clearcoat_smooth ? b.clearcoat : 0;
        over.clearcoat_alpha = b.clearcoat_ggx.alpha;
        over.clearcoat_masking = b.clearcoat_ggx.masking;
        over.sheen = max_component(b.sheen);
        over.sheen_lobe = b.sheen;
        over.sheen_alpha = b.sheen_alpha;
    }
    void operator()(const auto&) { reflects_alone = false; }

    void set_specular(Spectrum f0, Spectrum f90, const Ggx& ggx) {
        bsdf.specular_f0 = f0;
        bsdf.specular_f90 = f90;
        bsdf.ggx = ggx;
        bsdf.specular = !is_black(f0) || !is_black(f90);
    }
};

}  // namespace

std::optional<ReceiverBsdf> receiver_bsdf(const Vertex& vertex, const Frame& receiver) {
    Lobes lobes;
    std::visit([&](const auto& b) { lobes(b); }, vertex.bsdf);
    if (!lobes.reflects_alone) return {};
    const Frame& shading = vertex.point.frame;
    lobes.bsdf.w_out = vertex.w_out;
    lobes.bsdf.shading_x = receiver.to_local({shading.s}).v;
    lobes.bsdf.shading_y = receiver.to_local({shading.t}).v;
    lobes.bsdf.shading_z = receiver.to_local({shading.n}).v;
    return lobes.bsdf;
}

}  // namespace relumine
