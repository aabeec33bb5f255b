// SPDX-License-Identifier: Apache-2.0
// Binding Mitsuba's BSDFs and area emitters to shapes; baking their textures.
#include "scene/mitsuba_materials.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/message.hpp"
#include "scene/lobe_along.hpp"
#include "scene/quote.hpp"

namespace relumine {
namespace {

Spectrum to_unit(Spectrum c) {
    return {std::clamp(c.r, 0.0f, 1.0f), std::clamp(c.g, 0.0f, 1.0f), std::clamp(c.b, 0.0f, 1.0f)};
}

/// The lobe of a texture's values along u and v.
LobeAlong lobe_of(const MitsubaDraft& draft, float u, float v) {
    const auto alpha = [&](float value) {
        return std::clamp(draft.squared ? value * value : value, 0.0f, 1.0f);
    };
    return lobe_along(alpha(u) / draft.aspect, alpha(v) * draft.aspect);
}

/// The brightest value of a texture's leaves, by which emission is scaled to what an image can hold.
float peak_of(const PbrtNode& node) {
    float peak = max_component(node.value);
    if (node.pixels) {
        peak = 0;
        for (const Spectrum& c : node.pixels->rgb) peak = std::max(peak, max_component(c));
    }
    if (node.kind == PbrtNode::Kind::scale) return peak_of(*node.input[0]) * peak_of(*node.input[1]);
    for (const PbrtNodeRef& input : node.input)
        if (input) peak = std::max(peak, peak_of(*input));
    return peak;
}

}  // namespace

void MitsubaMaterials::apply(const PbrtBaked& baked, std::optional<TextureRef>& ref, Binding& binding) {
    ref = baked.texture;
    binding.by_domain = binding.by_domain || baked.by_domain;
}

void MitsubaMaterials::emit(const MitsubaElement& emitter, MitsubaDraft& draft,
                            const std::array<Vec2, 2>& domain, Binding& binding) {
    MitsubaProperties p(emitter, scene_);
    if (emitter.type == "directionalarea")
        refuse_pbrt(emitter.place, "emitter \"area\" in a shape",
                    "\"directionalarea\", which is not supported");
    const std::vector<std::string> types{"area"};
    if (emitter.type != "area")
        refuse_pbrt(emitter.place, "emitter \"area\" in a shape",
                    quote(emitter.type) + did_you_mean(emitter.type, types));
    const PbrtNodeRef radiance = textures_.color(p, "radiance", Spectrum{1}, MitsubaColorUse::light);
    p.ignore({"sampling_weight"});
    p.unsupported({"to_world"}, "the shape's is used");
    p.finish();
    if (is_constant(radiance)) {
        draft.material.emission = radiance->value;
        return;
    }
    const float peak = peak_of(*radiance);
    draft.material.emission = Spectrum{peak};
    if (!(peak > 0)) return;
    const auto unit = [peak](std::span<const Spectrum> v) {
        const Spectrum c = v[0] / peak;
        return Vec4{c.r, c.g, c.b, 1};
    };
    apply(textures_.baker().bake({radiance}, unit, true, peak == 1, domain, emitter.place),
          draft.material.emission_texture, binding);
}

void MitsubaMaterials::bake(MitsubaDraft& draft, const std::array<Vec2, 2>& domain, Binding& binding) {
    Material& m = draft.material;
    const bool cut = !(is_constant(draft.opacity) && draft.opacity->value.r >= 1);
    std::vector<PbrtNodeRef> nodes{draft.color};
    if (cut) nodes.push_back(draft.opacity);
    const auto surface = [&](std::span<const Spectrum> v) {
        const Spectrum c = to_unit(draft.recolor ? draft.recolor(v[0]) : v[0]);
        return Vec4{c.r, c.g, c.b, cut ? std::clamp(v[1].r, 0.0f, 1.0f) : 1.0f};
    };
    const PbrtBaked color =
        textures_.baker().bake(nodes, surface, true, !draft.recolor && !cut, domain, draft.place);
    apply(color, m.base_color_texture, binding);
    m.base_color = color.texture ? Spectrum{1} : Spectrum{color.value.x, color.value.y, color.value.z};
    if (cut) {
        m.alpha_mode = AlphaMode::blend;
        m.base_alpha = color.texture ? 1.0f : color.value.w;
    }
    if (draft.normal) {
        const auto as_it_is = [](std::span<const Spectrum> v) { return Vec4{v[0].r, v[0].g, v[0].b, 1}; };
        apply(textures_.baker().bake({draft.normal}, as_it_is, false, false, domain, draft.place),
              m.normal_texture, binding);
        binding.normal_map = m.normal_texture.has_value();
    }
    const PbrtNodeRef metallic = draft.metallic ? draft.metallic : constant_node(Spectrum{1});
    const PbrtNodeRef alpha = draft.alpha ? draft.alpha : constant_node({});
    const PbrtNodeRef alpha_v = draft.alpha_v ? draft.alpha_v : alpha;
    const auto rough = [&](std::span<const Spectrum> v) {
        return Vec4{1, lobe_of(draft, v[0].r, v[1].r).roughness, std::clamp(v[2].r, 0.0f, 1.0f), 1};
    };
    const PbrtBaked roughness =
        textures_.baker().bake({alpha, alpha_v, metallic}, rough, false, false, domain, draft.place);
    apply(roughness, m.metallic_roughness_texture, binding);
    m.roughness = roughness.texture ? 1.0f : roughness.value.y;
    if (!draft.alpha_v && draft.aspect == 1) return;
    const auto orient = [&](std::span<const Spectrum> v) {
        return anisotropy_texel(lobe_of(draft, v[0].r, v[1].r));
    };
    const PbrtBaked anisotropy =
        textures_.baker().bake({alpha, alpha_v}, orient, false, false, domain, draft.place);
    apply(anisotropy, m.anisotropy_texture, binding);
    set_anisotropy(m.anisotropy_texture, anisotropy.value, m);
}

/// Mitsuba's opaque BSDFs are black from behind unless `twosided`; ours are not.
void MitsubaMaterials::note_sides(const MitsubaDraft& draft) {
    if (draft.two_sided || noted_sides_) return;
    noted_sides_ = true;
    scene_.notes.warn(draft.place,
                      "without \"twosided\" the back of a surface is black in Mitsuba; here both "
                      "sides reflect (this and all others)");
}

MitsubaMaterials::Binding MitsubaMaterials::bind(const MitsubaElement* bsdf, const MitsubaElement* emitter,
                                                 const std::array<Vec2, 2>& uv_domain) {
    // Graphs that combine images are baked over the mesh's own range of u and v, in whole steps.
    const std::array<Vec2, 2> domain{
        Vec2{std::floor(uv_domain[0].x + 1e-4f), std::floor(uv_domain[0].y + 1e-4f)},
        Vec2{std::ceil(uv_domain[1].x - 1e-4f), std::ceil(uv_domain[1].y - 1e-4f)}};
    const Key general{bsdf, emitter, {}};
    const Key special{bsdf, emitter, {domain[0].x, domain[0].y, domain[1].x, domain[1].y}};
    if (const auto it = made_.find(general); it != made_.end() && !it->second.by_domain) return it->second;
    if (const auto it = made_.find(special); it != made_.end()) return it->second;
    MitsubaDraft draft;
    Binding binding;
    if (bsdf) {
        draft.place = bsdf->place;
        fill(*bsdf, draft);
        draft.material.name = bsdf->id.empty() ? bsdf->type : bsdf->id;
    } else {
        draft.material.metallic = draft.material.specular = 0;
        draft.material.name = "default";
        if (emitter) draft.place = emitter->place;
    }
    if (emitter) emit(*emitter, draft, domain, binding);
    if (!draft.visible && emitter) {
        draft.visible = true;
        draft.color = constant_node({});
        draft.material.metallic = draft.material.specular = draft.material.transmission = 0;
        draft.opacity = constant_node(Spectrum{1});
        scene_.notes.warn(draft.place,
                          "a light on a surface that lets light through is read as one on a black surface");
    }
    binding.visible = draft.visible;
    binding.inside_out = draft.inside_out;
    if (draft.visible) {
        if (bsdf) note_sides(draft);
        bake(draft, domain, binding);
        out_.materials.push_back(std::move(draft.material));
        binding.material = static_cast<MaterialId>(out_.materials.size() - 1);
    }
    made_[general] = binding;
    if (binding.by_domain) made_[special] = binding;
    return binding;
}

void MitsubaMaterials::check_unused(const MitsubaElement& root) {
    for (const auto& child : root.children) {
        if (child->tag != "bsdf") continue;
        MitsubaDraft draft;
        draft.place = child->place;
        fill(*child, draft);
    }
}

}  // namespace relumine
