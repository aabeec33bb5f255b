// SPDX-License-Identifier: Apache-2.0
// Mitsuba's BSDFs: one function per kind.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/message.hpp"
#include "scene/mitsuba_materials.hpp"
#include "scene/pbrt_materials.hpp"
#include "scene/quote.hpp"

namespace relumine {
namespace {

const std::vector<std::string> bsdf_types{
    "blendbsdf",       "bumpmap",      "conductor",      "dielectric", "diffuse",        "mask",
    "normalmap",       "null",         "plastic",        "principled", "principledthin", "roughconductor",
    "roughdielectric", "roughplastic", "thindielectric", "twosided"};

float conductor_f0(float eta, float k) {
    return ((eta - 1) * (eta - 1) + k * k) / ((eta + 1) * (eta + 1) + k * k);
}

void matte(MitsubaDraft& draft) {
    draft.material.metallic = 0;
    draft.material.specular = 0;
}

bool is_matte(const MitsubaDraft& d) {
    return d.material.metallic == 0 && d.material.specular == 0 && !d.metallic && !d.normal
           && d.material.transmission == 0 && d.visible && !d.recolor;
}

bool is_one(const PbrtNodeRef& node) { return is_constant(node) && node->value == Spectrum{1}; }

}  // namespace

void MitsubaMaterials::diffuse(MitsubaProperties& p, MitsubaDraft& draft) {
    matte(draft);
    draft.color = textures_.color(p, "reflectance", Spectrum{0.5f});
}

/// `int_ior` over `ext_ior`, or another name for the inner one.
double MitsubaMaterials::relative_ior(MitsubaProperties& p, const char* fallback) {
    const auto read = [&](const char* name, const char* otherwise) {
        const MitsubaElement* element = p.find(name);
        if (element && element->tag != "string") return p.number(name, 1);
        const std::string material = element ? element->attribute("value") : otherwise;
        const std::optional<double> ior = mitsuba_ior(material);
        if (!ior)
            p.refuse(name, "the name of a substance",
                     quote(material) + did_you_mean(material, mitsuba_ior_names()));
        return *ior;
    };
    const double inside = read("int_ior", fallback), outside = read("ext_ior", "air");
    if (!(inside > 0 && outside > 0))
        p.refuse(inside > 0 ? "ext_ior" : "int_ior", "an index of refraction above 0",
                 fmt::format("{:g}", inside > 0 ? outside : inside));
    return inside / outside;
}

void MitsubaMaterials::read_alpha(MitsubaProperties& p, MitsubaDraft& draft) {
    if (p.choice("distribution", {"beckmann", "ggx"}) == "beckmann")
        p.warn(fmt::format("distribution \"beckmann\" of {} is read as \"ggx\" of the same alpha",
                           quote(p.object().type)));
    p.ignore({"sample_visible"});
    draft.alpha = textures_.number(p, "alpha", 0.1);
    if (!p.find("alpha_u") && !p.find("alpha_v")) return;
    const PbrtNodeRef u = textures_.number(p, "alpha_u", 0.1), v = textures_.number(p, "alpha_v", 0.1);
    draft.alpha = u;
    if (!is_constant(u) || !is_constant(v) || u->value.r != v->value.r) draft.alpha_v = v;
}

void MitsubaMaterials::dielectric(MitsubaProperties& p, MitsubaDraft& draft) {
    const bool thin = p.object().type == "thindielectric";
    if (p.object().type == "roughdielectric") read_alpha(p, draft);
    double eta = relative_ior(p, "bk7");
    if (eta < 1) {
        eta = 1 / eta;
        draft.inside_out = !thin;
    }
    draft.color = textures_.color(p, "specular_transmittance", Spectrum{1});
    if (!is_one(textures_.color(p, "specular_reflectance", Spectrum{1})))
        p.warn(fmt::format("specular_reflectance of {} is read as 1", quote(p.object().type)));
    draft.material.metallic = 0;
    draft.material.transmission = 1;
    draft.material.solid = !thin;
    draft.material.ior = static_cast<float>(eta);
    draft.two_sided = true;
}

void MitsubaMaterials::conductor(MitsubaProperties& p, MitsubaDraft& draft) {
    if (p.object().type == "roughconductor") read_alpha(p, draft);
    const std::string name = p.string("material", "none");
    std::optional<Spectrum> f0 = mitsuba_metal(name);
    if (!f0)
        p.refuse("material", "the name of a metal", quote(name) + did_you_mean(name, mitsuba_metal_names()));
    if (p.find("eta") || p.find("k")) {
        if (name != "none") p.refuse("material", "either \"material\" or \"eta\" and \"k\"", "both");
        const PbrtNodeRef eta = textures_.color(p, "eta", {}, MitsubaColorUse::unbounded);
        const PbrtNodeRef k = textures_.color(p, "k", Spectrum{1}, MitsubaColorUse::unbounded);
        if (!is_constant(eta) || !is_constant(k))
            p.refuse("eta", "colours for \"eta\" and \"k\"", "a texture");
        const Spectrum n = eta->value, a = k->value;
        f0 = Spectrum{conductor_f0(n.r, a.r), conductor_f0(n.g, a.g), conductor_f0(n.b, a.b)};
    }
    if (std::min({f0->r, f0->g, f0->b}) < 0.999f)
        p.warn(fmt::format("the Fresnel reflectance of {} is Schlick's: exact at normal incidence",
                           quote(p.object().type)));
    draft.color = textures_.color(p, "specular_reflectance", Spectrum{1});
    if (*f0 != Spectrum{1}) draft.recolor = [f = *f0](Spectrum c) { return c * f; };
    draft.material.metallic = 1;
}

/// A refracting coat over a diffuse base. Where Mitsuba lets the base's colour alone (`nonlinear` false),
/// division by the light that the coat keeps inside cancels against what enters.
void MitsubaMaterials::plastic(MitsubaProperties& p, MitsubaDraft& draft) {
    if (p.object().type == "roughplastic") {
        read_alpha(p, draft);
        p.warn("the coat of \"roughplastic\" lets light through like a smooth one");
    }
    double eta = relative_ior(p, "polypropylene");
    if (eta < 1)
        p.refuse("int_ior", "an index inside that is not below the one outside",
                 fmt::format("a ratio of {:g}", eta));
    if (!is_one(textures_.color(p, "specular_reflectance", Spectrum{1})))
        p.warn(fmt::format("specular_reflectance of {} is read as 1", quote(p.object().type)));
    draft.color = textures_.color(p, "diffuse_reflectance", Spectrum{0.5f});
    const CoatedAlbedo coat(eta, 0, 100000);
    const auto entering = static_cast<float>(coat.entering());
    if (p.boolean("nonlinear", false))
        draft.recolor = [coat](Spectrum c) {
            return Spectrum{coat.base(c.r), coat.base(c.g), coat.base(c.b)};
        };
    draft.material.coated_diffuse = true;
    draft.material.specular = entering;
    draft.material.metallic = 0;
    draft.material.ior = static_cast<float>(eta);
}

void MitsubaMaterials::principled(MitsubaProperties& p, MitsubaDraft& draft) {
    Material& m = draft.material;
    const bool thin = p.object().type == "principledthin";
    p.warn(fmt::format("BSDF {} is approximated by glTF's metal, coat and glass", quote(p.object().type)));
    draft.color = textures_.color(p, "base_color", Spectrum{0.5f});
    draft.alpha = textures_.number(p, "roughness", 0.5);
    draft.squared = true;
    const PbrtNodeRef metallic = textures_.number(p, "metallic", 0);
    m.metallic = is_constant(metallic) ? std::clamp(metallic->value.r, 0.0f, 1.0f) : 1;
    if (!is_constant(metallic)) draft.metallic = metallic;
    const PbrtNodeRef anisotropic = textures_.number(p, "anisotropic", 0);
    if (!is_constant(anisotropic)) p.warn("a texture for anisotropic is not supported: 0 instead");
    if (is_constant(anisotropic))
        draft.aspect = std::sqrt(1 - 0.9f * std::clamp(anisotropic->value.r, 0.0f, 1.0f));
    const PbrtNodeRef through = textures_.number(p, "spec_trans", 0);
    if (!is_constant(through)) p.warn("a texture for spec_trans is not supported: 0 instead");
    m.transmission = is_constant(through) ? std::clamp(through->value.r, 0.0f, 1.0f) : 0;
    m.solid = !thin && m.transmission > 0;
    const double specular = p.number("specular", 0.5);
    const double from_specular = 2 / (1 - std::sqrt(0.08 * std::clamp(specular, 0.0, 1.0))) - 1;
    const double eta = p.number("eta", thin ? 1.5 : from_specular);
    if (!(eta >= 1 && eta < 100))
        p.refuse("eta", "an index of refraction of 1 to 100", fmt::format("{:g}", eta));
    m.ior = static_cast<float>(eta);
    for (const char* name : {"spec_tint", "sheen", "sheen_tint", "clearcoat", "flatness", "diff_trans"}) {
        const PbrtNodeRef node = textures_.number(p, name, 0);
        if (!is_constant(node) || node->value.r != 0)
            p.warn(fmt::format("{} of {} is not supported: 0 instead", quote(name), quote(p.object().type)));
    }
    p.ignore({"clearcoat_gloss", "main_specular_sampling_rate", "clearcoat_sampling_rate",
              "diffuse_reflectance_sampling_rate", "spec_reflectance_sampling_rate",
              "spec_trans_sampling_rate", "diff_trans_sampling_rate"});
    draft.two_sided = m.transmission > 0 || thin;
}

/// twosided, mask, normalmap, bumpmap: something about another BSDF.
void MitsubaMaterials::nested(MitsubaProperties& p, MitsubaDraft& draft) {
    const std::string& type = p.object().type;
    const std::vector<const MitsubaElement*> inner = p.objects("bsdf");
    const std::size_t most = type == "twosided" ? 2 : 1;
    if (inner.empty() || inner.size() > most)
        refuse_pbrt(p.object().place,
                    fmt::format("{} BSDF inside of {}", most == 2 ? "one or two" : "one", quote(type)),
                    fmt::format("{}", inner.size()));
    if (inner.size() == 2 && inner[0] != inner[1])
        p.warn("the second BSDF of \"twosided\", that of the back, is not read");
    fill(*inner[0], draft);
    if (type == "twosided") {
        draft.two_sided = true;
    } else if (type == "mask") {
        draft.opacity = textures_.number(p, "opacity", 0.5);
        if (is_constant(draft.opacity) && draft.opacity->value.r <= 0) draft.visible = false;
    } else if (type == "normalmap") {
        const MitsubaElement* map = p.find("normalmap");
        if (!map || map->tag != "texture") p.refuse("normalmap", "a texture called \"normalmap\"", "none");
        draft.normal = textures_.node(*map, MitsubaColorUse::unbounded);
        p.ignore({"flip_invalid_normals", "use_shadowing_function"});
    } else {
        p.warn("bump mapping is not supported: the surface stays smooth");
        p.ignore({"scale", "flip_invalid_normals", "use_shadowing_function"});
        (void)p.objects("texture");
    }
}

void MitsubaMaterials::blend(MitsubaProperties& p, MitsubaDraft& draft) {
    const std::vector<const MitsubaElement*> inner = p.objects("bsdf");
    if (inner.size() != 2)
        refuse_pbrt(p.object().place, "two BSDFs in \"blendbsdf\"", fmt::format("{}", inner.size()));
    const PbrtNodeRef weight = textures_.number(p, "weight", 0.5);
    MitsubaDraft a, b;
    a.place = b.place = draft.place;
    fill(*inner[0], a);
    fill(*inner[1], b);
    const float share = is_constant(weight) ? std::clamp(weight->value.r, 0.0f, 1.0f) : 0.5f;
    const auto mixed = [&](const PbrtNodeRef& x, const PbrtNodeRef& y) {
        auto node = std::make_shared<PbrtNode>();
        node->kind = PbrtNode::Kind::mix;
        node->input = {x, y, weight};
        return node;
    };
    draft = share < 0.5f ? a : b;
    draft.two_sided = a.two_sided && b.two_sided;
    if (is_matte(a) && is_matte(b) && is_one(a.opacity) && is_one(b.opacity)) {
        draft.color = mixed(a.color, b.color);
        return;
    }
    if (!a.visible || !b.visible) {  // a BSDF and nothing: a cut-out
        draft = a.visible ? a : b;
        draft.opacity = a.visible ? mixed(constant_node(Spectrum{1}), constant_node({}))
                                  : mixed(constant_node({}), constant_node(Spectrum{1}));
        draft.visible = a.visible || b.visible;
        return;
    }
    p.warn("\"blendbsdf\" is approximated by a material between its two");
    const Material &ma = a.material, &mb = b.material;
    if (ma.coated_diffuse || mb.coated_diffuse || ma.solid != mb.solid)
        return;  // the one of the larger share
    if (!a.recolor && !b.recolor) draft.color = mixed(a.color, b.color);
    draft.material.metallic = std::lerp(ma.metallic, mb.metallic, share);
    draft.material.specular = std::lerp(ma.specular, mb.specular, share);
    draft.material.transmission = std::lerp(ma.transmission, mb.transmission, share);
    if (draft.alpha) return;
    const MitsubaDraft& rough = a.alpha ? a : b;
    draft.alpha = rough.alpha;
    draft.alpha_v = rough.alpha_v;
}

void MitsubaMaterials::fill_surface(MitsubaProperties& p, MitsubaDraft& draft) {
    const std::string& type = p.object().type;
    const auto is = [&](std::initializer_list<const char*> names) {
        return std::ranges::any_of(names, [&](const char* name) { return type == name; });
    };
    if (is({"diffuse"}))
        diffuse(p, draft);
    else if (is({"dielectric", "thindielectric", "roughdielectric"}))
        dielectric(p, draft);
    else if (is({"conductor", "roughconductor"}))
        conductor(p, draft);
    else if (is({"plastic", "roughplastic"}))
        plastic(p, draft);
    else if (is({"principled", "principledthin"}))
        principled(p, draft);
    else if (is({"twosided", "mask", "normalmap", "bumpmap"}))
        nested(p, draft);
    else if (is({"blendbsdf"}))
        blend(p, draft);
    else if (is({"null"}))
        draft.visible = false;
    else
        refuse_pbrt(p.object().place, "a BSDF among " + one_of(bsdf_types),
                    quote(type) + did_you_mean(type, bsdf_types));
}

void MitsubaMaterials::fill(const MitsubaElement& bsdf, MitsubaDraft& draft) {
    constexpr int max_depth = 16;
    if (++depth_ > max_depth)
        refuse_pbrt(bsdf.place, fmt::format("at most {} BSDFs inside each other", max_depth),
                    "more, or a circle");
    MitsubaProperties p(bsdf, scene_);
    fill_surface(p, draft);
    p.finish();
    --depth_;
}

}  // namespace relumine
