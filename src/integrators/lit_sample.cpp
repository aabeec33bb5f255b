// SPDX-License-Identifier: Apache-2.0
// Comparing samples.
#include "integrators/lit_sample.hpp"

namespace relumine {
namespace {

constexpr float alike = 0.02f;           // relative difference of what lobes are made of
constexpr float least_cosine = 0.9998f;  // between normals: 1.1°
constexpr float alike_view = 0.03f;      // of a lobe's width
constexpr float least_albedo = 0.01f;    // that another may be divided by

bool near(Spectrum a, Spectrum b) {
    const float size = std::max(max_component(a), max_component(b));
    return std::abs(a.r - b.r) + std::abs(a.g - b.g) + std::abs(a.b - b.b) <= alike * size;
}

bool near(float a, float b) { return std::abs(a - b) <= alike * std::max(a, b); }

bool same_place(const GatherPoint& a, const GatherPoint& b, float footprint) {
    return a.depth == b.depth && dot(a.frame.n, b.frame.n) >= least_cosine
           && std::abs(dot(b.position - a.position, a.frame.n)) <= footprint;
}

/// Stretched by the same and in the same direction; axes have no sign.
bool same_orientation(const ReceiverBsdf& a, const ReceiverBsdf& b) {
    if (!is_anisotropic(a.ggx) && !is_anisotropic(b.ggx)) return true;
    return std::abs(a.ggx.stretch_x - b.ggx.stretch_x) <= alike * a.ggx.stretch_x
           && std::abs(dot(a.shading_x, b.shading_x)) >= least_cosine;
}

/// What is there is of one kind and alike.
bool same_layers(const OverLayers& a, const OverLayers& b) {
    const bool same_clearcoat = near(a.clearcoat, b.clearcoat) && near(a.clearcoat_lobe, b.clearcoat_lobe)
                                && (a.clearcoat == 0 || near(a.clearcoat_alpha, b.clearcoat_alpha));
    const bool same_sheen = near(a.sheen, b.sheen) && near(a.sheen_lobe, b.sheen_lobe)
                            && (a.sheen == 0 || near(a.sheen_alpha, b.sheen_alpha));
    return same_clearcoat && same_sheen && near(a.eta, b.eta);
}

bool same_lobes(const ReceiverBsdf& a, const ReceiverBsdf& b) {
    return same_layers(a.over, b.over) && same_orientation(a, b)
           && std::abs(a.ggx.alpha - b.ggx.alpha) <= alike * a.ggx.alpha && near(a.specular_f0, b.specular_f0)
           && near(a.specular_f90, b.specular_f90) && near(a.coat_f0, b.coat_f0)
           && near(a.coat_f90, b.coat_f90);
}

Vec3 view_of(const ReceiverBsdf& b) {
    return b.shading_x * b.w_out.v.x + b.shading_y * b.w_out.v.y + b.shading_z * b.w_out.v.z;
}

/// Whether b / a makes sense in every channel.
bool divides(Spectrum a, Spectrum b) {
    return (a.r >= least_albedo || b.r == 0) && (a.g >= least_albedo || b.g == 0)
           && (a.b >= least_albedo || b.b == 0);
}

}  // namespace

bool shares_integral(const LitSample& a, const LitSample& b, bool exact) {
    if (a.bsdf.specular != b.bsdf.specular || a.bsdf.coated != b.bsdf.coated
        || is_layered(a.bsdf) != is_layered(b.bsdf))
        return false;
    if (!same_place(a.pixel->cache.gather, b.pixel->cache.gather, a.pixel->cache.footprint)) return false;
    if (dot(a.bsdf.shading_z, b.bsdf.shading_z) < least_cosine) return false;
    const bool scales = divides(a.bsdf.diffuse, b.bsdf.diffuse);
    if (!has_layers(a.bsdf)) return scales;
    return same_lobes(a.bsdf, b.bsdf) && (near(a.bsdf.diffuse, b.bsdf.diffuse) || (scales && !exact));
}

bool seen_alike(const LitSample& a, const LitSample& b) {
    if (!has_layers(a.bsdf)) return true;
    const float width = std::min(least_width(a.bsdf), 1.0f);
    return length_squared(view_of(b.bsdf) - view_of(a.bsdf)) <= sqr(alike_view * width);
}

Spectrum diffuse_ratio(const LitSample& a, const LitSample& b) {
    const Spectrum from = a.bsdf.diffuse, to = b.bsdf.diffuse;
    if (has_layers(a.bsdf) && near(from, to)) return Spectrum{1};
    const auto ratio = [](float x, float y) { return y > 0 ? y / x : 0; };
    return {ratio(from.r, to.r), ratio(from.g, to.g), ratio(from.b, to.b)};
}

}  // namespace relumine
