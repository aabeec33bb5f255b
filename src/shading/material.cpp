// SPDX-License-Identifier: Apache-2.0
// Materials at points.
#include "shading/material.hpp"

#include "shading/coat.hpp"
#include "shading/texture.hpp"

namespace relumine {
namespace {

Spectrum rgb(Vec4 v) { return {v.x, v.y, v.z}; }

/// A material's factors times its textures at one point.
struct Factors {
    Spectrum base_color;
    float metallic, alpha_x, alpha_y /* GGX */, transmission, specular;
    Spectrum specular_color;

    /// Too smooth for anything but a delta.
    [[nodiscard]] bool smooth() const { return std::max(alpha_x, alpha_y) < smooth_alpha; }
    [[nodiscard]] Ggx ggx(Masking masking) const { return make_ggx(alpha_x, alpha_y, masking); }
};

/// How much rougher the lobes are along one direction, [0, 1].
float anisotropy_at(const SceneData& scene, const SurfacePoint& p) {
    const Material& m = *p.material;
    if (!m.anisotropy_texture || !is_anisotropic(m)) return m.anisotropy;
    return m.anisotropy * sample_texture(scene, *m.anisotropy_texture, p.uv, Encoding::linear).z;
}

Factors factors_at(const SceneData& scene, const SurfacePoint& p) {
    const Material& m = *p.material;
    Factors f{m.base_color * p.vertex_color, m.metallic, 0, 0, m.transmission, m.specular, m.specular_color};
    float roughness = m.roughness;
    if (m.base_color_texture)
        f.base_color *= rgb(sample_texture(scene, *m.base_color_texture, p.uv, Encoding::srgb));
    if (m.metallic_roughness_texture) {
        const Vec4 texel = sample_texture(scene, *m.metallic_roughness_texture, p.uv, Encoding::linear);
        roughness *= texel.y;
        f.metallic *= texel.z;
    }
    if (m.transmission_texture)
        f.transmission *= sample_texture(scene, *m.transmission_texture, p.uv, Encoding::linear).x;
    if (m.specular_texture)
        f.specular *= sample_texture(scene, *m.specular_texture, p.uv, Encoding::linear).w;
    if (m.specular_color_texture)
        f.specular_color *= rgb(sample_texture(scene, *m.specular_color_texture, p.uv, Encoding::srgb));
    f.alpha_x = f.alpha_y = sqr(roughness);
    if (is_anisotropic(m)) f.alpha_x = lerp(f.alpha_y, 1.0f, sqr(anisotropy_at(scene, p)));
    return f;
}

Spectrum clamped(Spectrum s) { return {std::min(s.r, 1.0f), std::min(s.g, 1.0f), std::min(s.b, 1.0f)}; }

Bsdf glass(const SurfacePoint& p, const Factors& f, Masking masking) {
    const Material& m = *p.material;
    const float eta = p.front || !m.solid ? m.ior : 1 / m.ior;
    if (f.smooth()) return SmoothDielectric{eta, f.base_color, !m.solid};
    // An index of 1 refracts nothing: only the thin model has a density then.
    if (m.solid && std::abs(eta - 1) < 1e-4f) return SmoothDielectric{eta, f.base_color, true};
    return RoughDielectric{eta, f.base_color, !m.solid, f.ggx(masking)};
}

float glass_share(const Factors& f) { return f.transmission * (1 - f.metallic); }

/// The share of metal in what is not glass.
float opaque_metal(const Factors& f) {
    return glass_share(f) > 0 ? f.metallic / (1 - glass_share(f)) : f.metallic;
}

/// What becomes of the light that arrives at a pane; the tint takes the rest.
struct PaneShares {
    Spectrum passed;         // goes straight on
    float mirrored, layers;  // reflected by the glass; meets the opaque layering instead of glass
};

PaneShares pane_shares(const SceneData& scene, const Hit& hit, const SurfacePoint& p, const Factors& f,
                       float cosine) {
    const Material& m = *p.material;
    const float there =
        m.alpha_mode == AlphaMode::opaque ? 1 : opacity(scene, m, texture_coordinates(scene, hit));
    const float r = sheet_reflectance(std::min(cosine, 1.0f), m.ior), glass = there * glass_share(f);
    return {Spectrum{1 - there} + f.base_color * (glass * (1 - r)), glass * r, there - glass};
}

/// The layering without its transmissive part: metal in the share `metallic` of it.
Bsdf opaque_layers(const Factors& f, float metallic, float ior, Masking masking) {
    const bool smooth = f.smooth();
    const Ggx ggx = f.ggx(masking);
    if (metallic >= 1) return smooth ? Bsdf{Mirror{f.base_color}} : Bsdf{RoughConductor{f.base_color, ggx}};
    const Spectrum coat_f0 = clamped(f.specular_color * sqr((ior - 1) / (ior + 1))) * f.specular;
    const Spectrum coat_f90{f.specular};
    if (metallic <= 0 && f.specular <= 0) return Lambert{f.base_color};
    const float below = mean_coat_transmittance(coat_f0, coat_f90, ggx);
    return MetallicRoughness{f.base_color * ((1 - metallic) / std::max(below, 1e-3f)),
                             coat_f0,
                             coat_f90,
                             lerp(coat_f0, f.base_color, metallic),
                             lerp(coat_f90, Spectrum{1}, metallic),
                             ggx,
                             smooth};
}

bool is_coated(const Material& m) { return m.clearcoat > 0 || !is_black(m.sheen_color); }

/// The layering with sheen and clear coat over it; metals and bare diffuse surfaces become layerings too.
Bsdf coated_layers(const SceneData& scene, const SurfacePoint& p, const Bsdf& base, Masking masking) {
    const Material& m = *p.material;
    CoatedLayers layers;
    if (const auto* below = std::get_if<MetallicRoughness>(&base)) {
        layers.base = *below;
        layers.base.diffuse *= mean_coat_transmittance(below->coat_f0, below->coat_f90, below->ggx);
    } else if (const auto* mirror = std::get_if<Mirror>(&base)) {
        layers.base = {{}, {}, {}, mirror->f0, Spectrum{1}, {smooth_alpha, masking}, true};
    } else {
        layers.base = *as_layers(base);
    }
    layers.clearcoat = m.clearcoat;
    if (m.clearcoat_texture)
        layers.clearcoat *= sample_texture(scene, *m.clearcoat_texture, p.uv, Encoding::linear).x;
    float roughness = m.clearcoat_roughness;
    if (m.clearcoat_roughness_texture)
        roughness *= sample_texture(scene, *m.clearcoat_roughness_texture, p.uv, Encoding::linear).y;
    layers.clearcoat_smooth = sqr(roughness) < smooth_alpha;
    layers.clearcoat_ggx = {std::clamp(sqr(roughness), smooth_alpha, 1.0f), masking};
    layers.sheen = m.sheen_color;
    if (m.sheen_color_texture)
        layers.sheen *= rgb(sample_texture(scene, *m.sheen_color_texture, p.uv, Encoding::srgb));
    roughness = m.sheen_roughness;
    if (m.sheen_roughness_texture)
        roughness *= sample_texture(scene, *m.sheen_roughness_texture, p.uv, Encoding::linear).w;
    layers.sheen_alpha = std::clamp(sqr(roughness), least_sheen_alpha, 1.0f);
    return layered(layers);
}

Bsdf coated_diffuse(const Factors& f, float ior, Masking masking) {
    const Spectrum base = f.base_color / std::max(f.specular, 1e-3f);
    return CoatedDiffuse{base, ior, f.ggx(masking), f.smooth(), true};
}

Bsdf diffuse_transmission(const SceneData& scene, const SurfacePoint& p, const Factors& f) {
    const Material& m = *p.material;
    Spectrum transmitted = m.diffuse_transmission;
    if (m.diffuse_transmission_texture)
        transmitted *= rgb(sample_texture(scene, *m.diffuse_transmission_texture, p.uv, Encoding::srgb));
    return DiffuseTransmission{f.base_color, transmitted};
}

}  // namespace

Bsdf make_bsdf(const SceneData& scene, const SurfacePoint& p, Masking masking, float u) {
    const Factors f = factors_at(scene, p);
    if (p.material->coated_diffuse) return coated_diffuse(f, p.material->ior, masking);
    if (!is_black(p.material->diffuse_transmission)) return diffuse_transmission(scene, p, f);
    if (u < glass_share(f)) return glass(p, f, masking);
    const Bsdf base = opaque_layers(f, opaque_metal(f), p.material->ior, masking);
    return is_coated(*p.material) ? coated_layers(scene, p, base, masking) : base;
}

Pane pane_kind(const SceneData& scene, const Mesh& mesh) {
    const Material& m = scene.materials[index(mesh.material)];
    const bool smooth = sqr(m.roughness) < smooth_alpha && !is_anisotropic(m);
    if (!(m.transmission > 0) || m.solid || !smooth || m.metallic >= 1 || !is_black(m.emission))
        return Pane::none;
    const bool grey = m.base_color.r == m.base_color.g && m.base_color.g == m.base_color.b;
    return grey && !m.base_color_texture && mesh.colors.empty() ? Pane::grey : Pane::coloured;
}

Spectrum pane_transmittance(const SceneData& scene, const Hit& hit, WorldDir direction) {
    const SurfacePoint p = surface_point(scene, hit, -direction);
    return pane_shares(scene, hit, p, factors_at(scene, p), dot(p.frame.n, -direction.v)).passed;
}

Bsdf make_pane_bsdf(const SceneData& scene, const Hit& hit, const SurfacePoint& p, LocalDir w_out,
                    Masking masking, float u) {
    const Factors f = factors_at(scene, p);
    const PaneShares shares = pane_shares(scene, hit, p, f, cos_theta(w_out));
    const float met = u * (1 - max_component(shares.passed));
    if (met < shares.mirrored) return Mirror{Spectrum{1}};
    if (met >= shares.mirrored + shares.layers) return Lambert{};  // what the tint has taken
    return opaque_layers(f, opaque_metal(f), p.material->ior, masking);
}

std::optional<MetallicRoughness> as_layers(const Bsdf& bsdf) {
    if (const auto* lambert = std::get_if<Lambert>(&bsdf))
        return MetallicRoughness{lambert->albedo, {}, {}, {}, {}, {}};
    if (const auto* metal = std::get_if<RoughConductor>(&bsdf))
        return MetallicRoughness{{}, {}, {}, metal->f0, Spectrum{1}, metal->ggx};
    const auto* layers = std::get_if<MetallicRoughness>(&bsdf);
    return layers && !layers->smooth ? std::optional(*layers) : std::nullopt;
}

UniformBsdfs::UniformBsdfs(const SceneData& scene, Masking masking) : first_(scene.materials.data()) {
    for (const Material& m : scene.materials) {
        const bool varies = m.base_color_texture || m.metallic_roughness_texture || m.transmission_texture
                            || m.specular_texture || m.specular_color_texture || m.transmission > 0
                            || m.diffuse_transmission_texture || m.clearcoat_texture
                            || m.clearcoat_roughness_texture || m.sheen_color_texture
                            || m.sheen_roughness_texture || (m.anisotropy_texture && is_anisotropic(m));
        SurfacePoint anywhere;
        anywhere.material = &m;
        bsdfs_.push_back(varies ? std::nullopt : std::optional(make_bsdf(scene, anywhere, masking, 0)));
        const bool plain = !varies && !m.normal_texture && !attenuates(m);
        layers_.push_back(plain ? as_layers(*bsdfs_.back()) : std::nullopt);
    }
}

Spectrum material_emission(const SceneData& scene, const Material& material, const TextureUv& uv) {
    if (!material.emission_texture || is_black(material.emission)) return material.emission;
    return material.emission * rgb(sample_texture(scene, *material.emission_texture, uv, Encoding::srgb));
}

Spectrum emitted_radiance(const SceneData& scene, const SurfacePoint& p) {
    if (!p.front && !p.material->double_sided) return {};
    return material_emission(scene, *p.material, p.uv);
}

float opacity(const SceneData& scene, const Material& material, const TextureCoordinates& at) {
    if (material.alpha_mode == AlphaMode::opaque) return 1;
    float alpha = material.base_alpha * at.vertex_alpha;
    if (material.base_color_texture)
        alpha *= sample_texture(scene, *material.base_color_texture, at.uv, Encoding::srgb).w;
    if (material.alpha_mode == AlphaMode::mask) return alpha >= material.alpha_cutoff ? 1.0f : 0.0f;
    return alpha;
}

Spectrum transmittance(const Material& material, float distance) {
    const float power = distance / material.attenuation_distance;
    const Spectrum& c = material.attenuation_color;
    return {std::pow(c.r, power), std::pow(c.g, power), std::pow(c.b, power)};
}

}  // namespace relumine
