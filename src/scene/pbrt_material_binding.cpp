// SPDX-License-Identifier: Apache-2.0
// Binding materials, area lights and cut-outs to shapes; baking their textures.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/message.hpp"
#include "scene/lobe_along.hpp"
#include "scene/pbrt_material_draft.hpp"
#include "scene/quote.hpp"

namespace relumine {
namespace {

/// GGX α of pbrt's roughness: the value itself or its square root.
float alpha_of(float value, bool remap) {
    return std::clamp(remap ? std::sqrt(std::max(value, 0.0f)) : value, 0.0f, 1.0f);
}

Vec4 opaque(Spectrum c) { return {c.r, c.g, c.b, 1}; }

}  // namespace

void PbrtMaterials::apply(const PbrtBaked& baked, std::optional<TextureRef>& ref, Draft& draft) {
    ref = baked.texture;
    draft.by_domain = draft.by_domain || baked.by_domain;
    if (length_squared(baked.axis) > 0) {
        if (length_squared(draft.axis) > 0 && !(draft.axis == baked.axis))
            scene_.warn(draft.place,
                        "one material mixes by several directions: only the last of them is read");
        draft.axis = baked.axis;
    }
    if (!ref || ref->uv_set == 0) return;
    if (draft.mapping && !(*draft.mapping == baked.mapping))
        scene_.warn(draft.place, "one material uses several mappings: only the last of them is read");
    draft.mapping = baked.mapping;
}

void PbrtMaterials::finish_textures(Draft& draft) {
    Material& m = draft.material;
    const auto recolor = draft.recolor;
    const bool cut = !(is_constant(draft.alpha) && draft.alpha->value.r >= 1);
    std::vector<PbrtNodeRef> nodes{draft.color};
    if (cut) nodes.push_back(draft.alpha);
    const auto combine = [&](std::span<const Spectrum> v) {
        Spectrum c = recolor ? recolor(v[0]) : v[0];
        c = {std::clamp(c.r, 0.0f, 1.0f), std::clamp(c.g, 0.0f, 1.0f), std::clamp(c.b, 0.0f, 1.0f)};
        return Vec4{c.r, c.g, c.b, cut ? std::clamp(v[1].r, 0.0f, 1.0f) : 1.0f};
    };
    const PbrtBaked color = textures_.bake(nodes, combine, true, !recolor && !cut, draft.domain, draft.place);
    apply(color, m.base_color_texture, draft);
    m.base_color = color.texture ? Spectrum{1} : Spectrum{color.value.x, color.value.y, color.value.z};
    if (cut) {
        m.alpha_mode = AlphaMode::blend;
        m.base_alpha = color.texture ? 1.0f : color.value.w;
    }
    if (draft.normal)
        apply(textures_.bake(
                  {draft.normal}, [](std::span<const Spectrum> v) { return opaque(v[0]); }, false, false,
                  draft.domain, draft.place),
              m.normal_texture, draft);
    if (draft.transmittance) {
        const auto clamped = [&](std::span<const Spectrum> v) {
            const Spectrum c = recolor ? recolor(v[0]) : v[0];
            return opaque(
                {std::clamp(c.r, 0.0f, 1.0f), std::clamp(c.g, 0.0f, 1.0f), std::clamp(c.b, 0.0f, 1.0f)});
        };
        const PbrtBaked through =
            textures_.bake({draft.transmittance}, clamped, true, false, draft.domain, draft.place);
        apply(through, m.diffuse_transmission_texture, draft);
        m.diffuse_transmission =
            through.texture ? Spectrum{1} : Spectrum{through.value.x, through.value.y, through.value.z};
    }
    if (!draft.roughness) {
        m.roughness = 0;
        return;
    }
    finish_roughness(draft);
}

void PbrtMaterials::finish_roughness(Draft& draft) {
    Material& m = draft.material;
    const bool remap = draft.remap;
    std::vector<PbrtNodeRef> nodes{draft.roughness};
    if (draft.roughness_v) nodes.push_back(draft.roughness_v);
    const auto lobe = [&](std::span<const Spectrum> v) {
        return lobe_along(alpha_of(v[0].r, remap), alpha_of(v[v.size() - 1].r, remap));
    };
    const PbrtBaked roughness = textures_.bake(
        nodes,
        [&](std::span<const Spectrum> v) {
            return Vec4{1, lobe(v).roughness, 1, 1};
        },
        false, false, draft.domain, draft.place);
    apply(roughness, m.metallic_roughness_texture, draft);
    m.roughness = roughness.texture ? 1.0f : roughness.value.y;
    if (!draft.roughness_v) return;
    const PbrtBaked anisotropy = textures_.bake(
        nodes, [&](std::span<const Spectrum> v) { return anisotropy_texel(lobe(v)); }, false, false,
        draft.domain, draft.place);
    apply(anisotropy, m.anisotropy_texture, draft);
    set_anisotropy(m.anisotropy_texture, anisotropy.value, m);
}

void PbrtMaterials::emit(const PbrtEntity& light, double area, Draft& draft) {
    const PbrtParameters& p = light.parameters;
    if (light.type != "diffuse") {
        const std::vector<std::string> types{"diffuse"};
        refuse_pbrt(p.place(), "the area light \"diffuse\"",
                    quote(light.type) + did_you_mean(light.type, types));
    }
    const std::string file = p.string("filename", "");
    const PbrtParameter* color = p.find_spectrum("L");
    if (color && !file.empty()) p.refuse("L", "either \"L\" or \"filename\"", "both");
    Spectrum radiance = color ? pbrt_rgb(*color, PbrtSpectrumUse::illuminant, files_) : Spectrum{1};
    double scale = p.number("scale", 1);
    const double power = p.number("power", -1);
    const bool two_sided = p.boolean("twosided", false);
    if (scale < 0) p.refuse("scale", "a scale of at least 0", fmt::format("{:g}", scale));
    double mean = 1, peak = 1;
    if (!file.empty()) {
        auto node = std::make_shared<PbrtNode>();
        node->kind = PbrtNode::Kind::image;
        node->wrap = Wrap::clamp;
        node->pixels = textures_.pixels(file, "sRGB", p.place());
        mean = peak = 0;
        for (const Spectrum& c : node->pixels->rgb) {
            mean += double{luminance(c)} / static_cast<double>(node->pixels->rgb.size());
            peak = std::max(peak, double{max_component(c)});
        }
        const auto unit = [peak](std::span<const Spectrum> v) {
            return opaque(peak > 0 ? v[0] / static_cast<float>(peak) : Spectrum{});
        };
        apply(textures_.bake({node}, unit, true, peak == 1, draft.domain, p.place()),
              draft.material.emission_texture, draft);
        radiance = Spectrum{static_cast<float>(peak)};
    }
    if (power > 0 && area > 0 && mean > 0)
        scale *= power / (mean * (two_sided ? 2 : 1) * area * 3.14159265358979);
    p.finish();
    draft.material.emission = radiance * static_cast<float>(scale);
    draft.material.double_sided = two_sided;
}

bool PbrtMaterials::by_power(const PbrtShape& shape) const {
    return shape.area_light && scene_.area_lights[*shape.area_light].parameters.number("power", -1) > 0;
}

bool PbrtMaterials::needs_uv(const PbrtShape& shape) {
    const PbrtEntity& entity = find(shape.material);
    const PbrtParameters& p = shape.entity.parameters;
    if (p.find_texture("alpha")) return true;
    if (shape.area_light && scene_.area_lights[*shape.area_light].parameters.has("filename")) return true;
    const std::string key = fmt::format("{}:{}", shape.material.number, shape.material.name);
    if (const auto it = needs_uv_.find(key); it != needs_uv_.end()) return it->second;
    bool textured = entity.type == "mix" || entity.parameters.has("normalmap");
    for (const char* name : {"uroughness", "vroughness", "conductor.uroughness", "conductor.vroughness"})
        textured = textured || entity.parameters.has(name);  // it follows u
    for (const char* name : {"reflectance", "roughness", "uroughness", "vroughness", "conductor.roughness",
                             "conductor.uroughness", "conductor.vroughness", "transmittance"})
        textured = textured || entity.parameters.find_texture(name) != nullptr;
    return needs_uv_[key] = textured;
}

PbrtMaterials::Binding PbrtMaterials::make(const PbrtShape& shape, const PbrtEntity& entity,
                                           const std::array<Vec2, 2>& domain, double area) {
    Draft draft;
    draft.place = shape.entity.parameters.place();
    draft.domain = domain;
    fill(entity, draft);
    draft.material.name = shape.material.name.empty()
                              ? fmt::format("{} {}", entity.type, shape.material.number)
                              : shape.material.name;
    draft.alpha = textures_.number(shape.entity.parameters, "alpha", 1);
    const bool cut_out = is_constant(draft.alpha) && draft.alpha->value.r <= 0;
    if (shape.area_light) {
        emit(scene_.area_lights[*shape.area_light], area, draft);
        if (!draft.visible) {
            draft.visible = true;
            draft.color = constant_node({});
            draft.material.metallic = draft.material.specular = 0;
            scene_.warn(draft.place, "a light on an interface is read as one on a black surface");
        }
        if (cut_out) {
            draft.alpha = constant_node(Spectrum{1});
            scene_.warn(draft.place, "an invisible area light (\"alpha\" 0) is read as a visible one");
        }
    } else if (cut_out) {
        draft.visible = false;
    }
    if (!draft.visible) return {{}, {}, {}, false, false, false};
    finish_textures(draft);
    out_.materials.push_back(std::move(draft.material));
    return {static_cast<MaterialId>(out_.materials.size() - 1),
            draft.mapping,
            draft.axis,
            true,
            draft.by_domain,
            draft.inside_out};
}

PbrtMaterials::Binding PbrtMaterials::bind(const PbrtShape& shape, const std::array<Vec2, 2>& uv_domain,
                                           double area) {
    const PbrtEntity& entity = find(shape.material);
    const PbrtParameters& p = shape.entity.parameters;
    const PbrtParameter* alpha = p.find_texture("alpha");
    const bool powered = by_power(shape);
    std::string key = fmt::format("{}:{}|{}|{}:{:.9g}|{:.5g}", shape.material.number, shape.material.name,
                                  shape.area_light ? static_cast<long>(*shape.area_light) : -1L,
                                  alpha ? alpha->strings[0] : "", p.number("alpha", 1), powered ? area : 0.0);
    // Graphs that combine images are baked over the mesh's own range of u and v, in whole steps.
    const std::array<Vec2, 2> domain{
        Vec2{std::floor(uv_domain[0].x + 1e-4f), std::floor(uv_domain[0].y + 1e-4f)},
        Vec2{std::ceil(uv_domain[1].x - 1e-4f), std::ceil(uv_domain[1].y - 1e-4f)}};
    auto it = made_.find(key);
    if (it != made_.end() && it->second.by_domain) {
        key += fmt::format("|{:g},{:g},{:g},{:g}", domain[0].x, domain[0].y, domain[1].x, domain[1].y);
        it = made_.find(key);
    }
    if (it != made_.end()) return it->second;
    const Binding binding = make(shape, entity, domain, area);
    if (binding.by_domain) {
        made_.try_emplace(key, binding);
        key += fmt::format("|{:g},{:g},{:g},{:g}", domain[0].x, domain[0].y, domain[1].x, domain[1].y);
    }
    return made_[key] = binding;
}

void PbrtMaterials::check_unused() {
    const auto check = [&](const PbrtEntity& entity) {
        Draft draft;
        draft.place = entity.parameters.place();
        fill(entity, draft);
    };
    for (const PbrtEntity& entity : scene_.materials) check(entity);
    for (const auto& [name, entity] : scene_.named_materials) check(entity);
}

}  // namespace relumine
