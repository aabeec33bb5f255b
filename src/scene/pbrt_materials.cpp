// SPDX-License-Identifier: Apache-2.0
// pbrt's materials and area lights as our material.
#include "scene/pbrt_materials.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/message.hpp"
#include "scene/quote.hpp"

namespace relumine {

/// A material on the way: ours, and the nodes that its textures are baked from.
struct PbrtMaterials::Draft {
    Material material;
    PbrtPlace place;
    std::string type;
    PbrtNodeRef color = constant_node(Spectrum{0.5f});           // before `recolor`
    std::function<Spectrum(Spectrum)> recolor;                   // to our base colour; empty: the same
    PbrtNodeRef roughness;                                       // as pbrt says it; null: perfectly smooth
    bool remap = true;
    PbrtNodeRef alpha = constant_node(Spectrum{1});
    std::optional<PbrtMapping> mapping;
    std::array<Vec2, 2> domain{};
    PbrtNodeRef normal;  // of the normal map, or null
    bool visible = true, by_domain = false;
};

namespace {

const std::vector<std::string> material_types{"coatedconductor", "coateddiffuse",      "conductor",
                                              "dielectric",      "diffuse",            "diffusetransmission",
                                              "hair",            "interface",          "measured",
                                              "mix",             "subsurface",         "thindielectric"};

/// Fresnel reflectance of unpolarised light, entering.
double fresnel(double cosine, double eta) {
    const double sin2 = (1 - cosine * cosine) / (eta * eta);
    if (sin2 >= 1) return 1;
    const double c = std::sqrt(1 - sin2);
    const double parallel = (eta * cosine - c) / (eta * cosine + c);
    const double perpendicular = (cosine - eta * c) / (cosine + eta * c);
    return 0.5 * (parallel * parallel + perpendicular * perpendicular);
}

/// The share of diffuse light that a boundary reflects.
double diffuse_fresnel(double eta) {
    constexpr int steps = 256;
    double sum = 0;
    for (int i = 0; i < steps; ++i) {
        const double cosine = (i + 0.5) / steps;
        sum += 2 * cosine * fresnel(cosine, eta) / steps;
    }
    return sum;
}

/// The mean over cosine-weighted directions of what our coat lets through, at the facet between them.
double our_transmittance(double f0) {
    constexpr int steps = 16;
    double sum = 0;
    for (int i = 0; i < steps; ++i)
        for (int j = 0; j < steps; ++j)
            for (int k = 0; k < steps; ++k) {
                const double c1 = std::sqrt((i + 0.5) / steps), c2 = std::sqrt((j + 0.5) / steps);
                const double phi = 3.14159265358979 * (k + 0.5) / steps;
                const double between = c1 * c2 + std::sqrt((1 - c1 * c1) * (1 - c2 * c2)) * std::cos(phi);
                const double half = std::sqrt(std::max(0.0, (1 + between) / 2));
                sum += 1 - (f0 + (1 - f0) * std::pow(1 - half, 5));
            }
    return sum / (steps * steps * steps);
}

double conductor_f0(double eta, double k) {
    return ((eta - 1) * (eta - 1) + k * k) / ((eta + 1) * (eta + 1) + k * k);
}

Spectrum per_channel(Spectrum a, Spectrum b, const std::function<double(double, double)>& f) {
    return {static_cast<float>(f(double{a.r}, double{b.r})), static_cast<float>(f(double{a.g}, double{b.g})),
            static_cast<float>(f(double{a.b}, double{b.b}))};
}

/// Our perceptual roughness of pbrt's, whose α is the value itself or its square root.
float our_roughness(float value, bool remap) {
    const float alpha = std::clamp(remap ? std::sqrt(std::max(value, 0.0f)) : value, 0.0f, 1.0f);
    return alpha < 1e-3f ? 0.0f : std::sqrt(alpha);
}

Vec4 opaque(Spectrum c) { return {c.r, c.g, c.b, 1}; }

}  // namespace

CoatedAlbedo::CoatedAlbedo(double eta, double thickness) {
    const double outside = diffuse_fresnel(eta), inside = 1 - (1 - outside) / (eta * eta);
    const double critical = std::sqrt(std::max(0.0, 1 - 1 / (eta * eta)));
    const double straight = std::exp(-2 * thickness / (1 + critical));  // one way through, inside the cone
    const double trapped = critical > 0 ? std::exp(-4 * thickness / critical) : 1;  // there and back, outside it
    enter_ = (1 - outside) * straight;
    leave_ = (1 - inside) * straight;
    inside_ = inside * trapped;
    const double f0 = (eta - 1) * (eta - 1) / ((eta + 1) * (eta + 1));
    ours_ = our_transmittance(f0);
}

float CoatedAlbedo::equivalent(float base) const {
    const double b = std::clamp(double{base}, 0.0, 1.0);
    return static_cast<float>(std::clamp(enter_ * b * leave_ / (1 - b * inside_) / ours_, 0.0, 1.0));
}

const PbrtEntity& PbrtMaterials::find(const PbrtMaterialRef& ref) const {
    if (ref.name.empty()) return scene_.materials[ref.number];
    const auto it = scene_.named_materials.find(ref.name);
    if (it != scene_.named_materials.end()) return it->second;
    std::vector<std::string> names;
    for (const auto& [name, material] : scene_.named_materials) names.push_back(name);
    refuse_pbrt(ref.place, "the name of a material", quote(ref.name) + did_you_mean(ref.name, names));
}

void PbrtMaterials::read_surface(const PbrtParameters& p, Draft& draft) {
    if (const std::string file = p.string("normalmap", ""); !file.empty()) {
        auto node = std::make_shared<PbrtNode>();
        node->kind = PbrtNode::Kind::image;
        node->pixels = textures_.pixels(file, "linear", p.place());
        draft.normal = std::move(node);
    }
    if (p.has("displacement")) {
        scene_.warn(p.place(), fmt::format("bump mapping (\"displacement\" of {}) is not supported",
                                           quote(draft.type)));
        p.ignore({"displacement"});
    }
}

void PbrtMaterials::read_roughness(const PbrtParameters& p, const std::string& prefix, Draft& draft) {
    draft.remap = p.boolean("remaproughness", true);
    PbrtNodeRef u = textures_.number_or_null(p, prefix + "uroughness");
    PbrtNodeRef v = textures_.number_or_null(p, prefix + "vroughness");
    PbrtNodeRef both = textures_.number(p, prefix + "roughness", 0);
    if (!u) u = both;
    if (!v) v = both;
    draft.roughness = u;
    const bool anisotropic = u != v && !(is_constant(u) && is_constant(v) && u->value == v->value);
    if (!anisotropic) return;
    scene_.warn(p.place(), "roughness that differs along u and v is read as their mean");
    if (is_constant(u) && is_constant(v))
        draft.roughness = constant_node(Spectrum{std::sqrt(std::max(0.0f, u->value.r * v->value.r))});
}

double PbrtMaterials::read_eta(const PbrtParameters& p, std::string_view name) {
    double eta = 1.5;
    if (const PbrtNodeRef number = textures_.number_or_null(p, name)) {
        if (is_constant(number)) eta = double{number->value.r};
        else scene_.warn(p.place(), fmt::format("a texture for {} is read as 1.5", quote(name)));
    } else if (const PbrtNodeRef spectrum = textures_.spectrum_or_null(p, name, PbrtSpectrumUse::unbounded)) {
        const Spectrum v = spectrum->value;
        if (is_constant(spectrum)) eta = (double{v.r} + double{v.g} + double{v.b}) / 3;
    }
    if (!(eta > 0)) p.refuse(name, "an index of refraction above 0", fmt::format("{:g}", eta));
    return eta;
}

void PbrtMaterials::diffuse(const PbrtEntity& entity, Draft& draft) {
    draft.color = textures_.spectrum(entity.parameters, "reflectance", Spectrum{0.5f}, PbrtSpectrumUse::albedo);
    draft.material.metallic = 0;
    draft.material.specular = 0;
    if (entity.parameters.has("sigma")) {
        scene_.warn(entity.parameters.place(), "\"sigma\" of \"diffuse\" is not part of pbrt-v4");
        entity.parameters.ignore({"sigma"});
    }
}

void PbrtMaterials::coated_diffuse(const PbrtEntity& entity, Draft& draft) {
    const PbrtParameters& p = entity.parameters;
    draft.color = textures_.spectrum(p, "reflectance", Spectrum{0.5f}, PbrtSpectrumUse::albedo);
    const double eta = read_eta(p, "eta");
    const PbrtNodeRef thickness = textures_.number(p, "thickness", 0.01);
    read_roughness(p, "", draft);
    p.ignore({"maxdepth", "nsamples", "g"});
    if (p.has("albedo")) scene_.warn(p.place(), "a medium inside the coat (\"albedo\") is not supported");
    p.ignore({"albedo"});
    const CoatedAlbedo coat(std::max(eta, 1.0), is_constant(thickness) ? double{thickness->value.r} : 0.01);
    draft.recolor = [coat](Spectrum c) {
        return Spectrum{coat.equivalent(c.r), coat.equivalent(c.g), coat.equivalent(c.b)};
    };
    draft.material.metallic = 0;
    draft.material.ior = static_cast<float>(std::max(eta, 1.0));
}

void PbrtMaterials::conductor(const PbrtEntity& entity, Draft& draft) {
    const PbrtParameters& p = entity.parameters;
    const PbrtNodeRef reflectance = textures_.spectrum_or_null(p, "reflectance", PbrtSpectrumUse::albedo);
    if (reflectance && (p.has("eta") || p.has("k")))
        p.refuse("reflectance", "either \"reflectance\" or \"eta\" and \"k\"", "both");
    read_roughness(p, "", draft);
    draft.material.metallic = 1;
    if (reflectance) {
        draft.color = reflectance;
        return;
    }
    const PbrtNodeRef eta = textures_.spectrum(p, "eta", {.1071f, .9772f, 1.2047f}, PbrtSpectrumUse::unbounded);
    const PbrtNodeRef k = textures_.spectrum(p, "k", {2.861f, 2.6244f, 2.3604f}, PbrtSpectrumUse::unbounded);
    if (!is_constant(eta) || !is_constant(k))
        scene_.warn(p.place(), "textures for \"eta\" and \"k\" are not supported; copper instead");
    const bool known = is_constant(eta) && is_constant(k);
    draft.color = constant_node(known ? per_channel(eta->value, k->value, conductor_f0)
                                      : Spectrum{.9545f, .638f, .5381f});
}

void PbrtMaterials::coated_conductor(const PbrtEntity& entity, Draft& draft) {
    const PbrtParameters& p = entity.parameters;
    scene_.warn(p.place(), "material \"coatedconductor\" is approximated by a conductor that its coat tints");
    const double coat = std::max(1.0, read_eta(p, "interface.eta"));
    const double f_coat = (coat - 1) * (coat - 1) / ((coat + 1) * (coat + 1));
    const PbrtNodeRef reflectance = textures_.spectrum_or_null(p, "reflectance", PbrtSpectrumUse::albedo);
    const PbrtNodeRef eta =
        textures_.spectrum(p, "conductor.eta", {.1071f, .9772f, 1.2047f}, PbrtSpectrumUse::unbounded);
    const PbrtNodeRef k =
        textures_.spectrum(p, "conductor.k", {2.861f, 2.6244f, 2.3604f}, PbrtSpectrumUse::unbounded);
    read_roughness(p, "conductor.", draft);
    p.ignore({"interface.roughness", "interface.uroughness", "interface.vroughness", "thickness", "maxdepth",
              "nsamples", "g", "albedo"});
    draft.material.metallic = 1;
    draft.color = reflectance ? reflectance
                              : constant_node(per_channel(eta->value, k->value, [&](double n, double kk) {
                                    return conductor_f0(n / coat, kk / coat);
                                }));
    draft.recolor = [f_coat](Spectrum metal) {  // the light that goes to and fro between coat and metal
        const auto both = [&](float m) {
            const double f = double{m};
            return static_cast<float>(f_coat + (1 - f_coat) * (1 - f_coat) * f / (1 - f_coat * f));
        };
        return Spectrum{both(metal.r), both(metal.g), both(metal.b)};
    };
}

void PbrtMaterials::dielectric(const PbrtEntity& entity, Draft& draft) {
    const PbrtParameters& p = entity.parameters;
    const bool thin = entity.type == "thindielectric";
    double eta = read_eta(p, "eta");
    if (!thin) read_roughness(p, "", draft);
    if (eta < 1) {
        scene_.warn(p.place(), fmt::format("an index of refraction of {:g} is read as 1", eta));
        eta = 1;
    }
    draft.color = constant_node(Spectrum{1});
    draft.material.metallic = 0;
    draft.material.transmission = 1;
    draft.material.solid = !thin;
    draft.material.ior = static_cast<float>(eta);
}

void PbrtMaterials::diffuse_transmission(const PbrtEntity& entity, Draft& draft) {
    const PbrtParameters& p = entity.parameters;
    scene_.warn(p.place(), "material \"diffusetransmission\" reflects, but transmits nothing");
    draft.color = textures_.spectrum(p, "reflectance", Spectrum{0.25f}, PbrtSpectrumUse::albedo);
    (void)textures_.spectrum(p, "transmittance", Spectrum{0.25f}, PbrtSpectrumUse::albedo);
    const auto scale = static_cast<float>(p.number("scale", 1));
    draft.recolor = [scale](Spectrum c) { return c * scale; };
    draft.material.metallic = 0;
    draft.material.specular = 0;
}

void PbrtMaterials::mix(const PbrtEntity& entity, Draft& draft) {
    const PbrtParameters& p = entity.parameters;
    const std::vector<std::string> names = p.strings("materials");
    if (names.size() != 2) p.refuse("materials", "two names of materials", fmt::format("{}", names.size()));
    const PbrtNodeRef amount = textures_.number(p, "amount", 0.5);
    if (++mix_depth_ > 16) refuse_pbrt(p.place(), "mixed materials that end", "a circle");
    std::array<Draft, 2> parts;
    for (std::size_t i = 0; i < 2; ++i) {
        parts[i].place = draft.place;
        parts[i].domain = draft.domain;
        fill(find({0, names[i], p.place()}), parts[i]);
    }
    --mix_depth_;
    const auto is_matte = [](const Draft& d) { return d.material.metallic == 0 && d.material.specular == 0; };
    const Material &a = parts[0].material, &b = parts[1].material;
    auto color = std::make_shared<PbrtNode>();
    color->kind = PbrtNode::Kind::mix;
    color->input = {parts[0].color, parts[1].color, amount};
    const bool matte = is_matte(parts[0]) && is_matte(parts[1]) && !parts[0].recolor && !parts[1].recolor;
    const float share = is_constant(amount) ? std::clamp(amount->value.r, 0.0f, 1.0f) : 0.5f;
    if (matte) {
        draft.material = a;
        draft.color = std::move(color);
        return;
    }
    scene_.warn(p.place(), "material \"mix\" is approximated by a material between its two");
    const bool alike = a.transmission == b.transmission;
    const Draft& main = share < 0.5f ? parts[0] : parts[1];
    draft.material = main.material;
    draft.recolor = main.recolor;
    draft.remap = main.remap;
    draft.color = main.color;
    draft.roughness = main.roughness;
    if (!alike) {
        draft.material.transmission = std::lerp(a.transmission, b.transmission, share);
        draft.material.solid = a.transmission > 0 ? a.solid : b.solid;
        const Draft& rest = a.transmission > 0 ? parts[1] : parts[0];
        draft.color = rest.color;
        draft.recolor = rest.recolor;
        return;
    }
    if (!parts[0].recolor && !parts[1].recolor) draft.color = std::move(color);
    draft.material.metallic = std::lerp(a.metallic, b.metallic, share);
    draft.material.specular = std::lerp(a.specular, b.specular, share);
    if (!draft.roughness) draft.roughness = parts[0].roughness ? parts[0].roughness : parts[1].roughness;
}

void PbrtMaterials::unsupported(const PbrtEntity& entity, Draft& draft) {
    scene_.warn(entity.parameters.place(),
                fmt::format("material {} is not supported: a grey diffuse one instead", quote(entity.type)));
    const PbrtNodeRef color =
        entity.type == "subsurface"
            ? textures_.spectrum_or_null(entity.parameters, "reflectance", PbrtSpectrumUse::albedo)
            : nullptr;
    if (color) draft.color = color;
    entity.parameters.ignore({"mfp", "mfree", "sigma_a", "sigma_s", "name", "g", "scale", "eta", "roughness",
                              "uroughness", "vroughness", "remaproughness", "reflectance", "filename", "color",
                              "eumelanin", "pheomelanin", "beta_m", "beta_n", "alpha"});
    draft.material.metallic = 0;
    draft.material.specular = 0;
}

void PbrtMaterials::fill(const PbrtEntity& entity, Draft& draft) {
    const std::string& type = entity.type;
    const PbrtParameters& p = entity.parameters;
    draft.type = type;
    (void)p.string("type", "");  // of MakeNamedMaterial
    if (type == "diffuse")
        diffuse(entity, draft);
    else if (type == "coateddiffuse")
        coated_diffuse(entity, draft);
    else if (type == "conductor")
        conductor(entity, draft);
    else if (type == "coatedconductor")
        coated_conductor(entity, draft);
    else if (type == "dielectric" || type == "thindielectric")
        dielectric(entity, draft);
    else if (type == "diffusetransmission")
        diffuse_transmission(entity, draft);
    else if (type == "mix")
        mix(entity, draft);
    else if (type == "interface" || type.empty() || type == "none")
        draft.visible = false;
    else if (type == "subsurface" || type == "measured" || type == "hair")
        unsupported(entity, draft);
    else
        refuse_pbrt(p.place(), "a material among " + one_of(material_types),
                    quote(type) + did_you_mean(type, material_types));
    read_surface(p, draft);
    p.finish();
}

void PbrtMaterials::apply(const PbrtBaked& baked, std::optional<TextureRef>& ref, Draft& draft) {
    ref = baked.texture;
    draft.by_domain = draft.by_domain || baked.by_domain;
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
        apply(textures_.bake({draft.normal}, [](std::span<const Spectrum> v) { return opaque(v[0]); }, false,
                             false, draft.domain, draft.place),
              m.normal_texture, draft);
    if (!draft.roughness) {
        m.roughness = 0;
        return;
    }
    const bool remap = draft.remap;
    const PbrtBaked roughness = textures_.bake(
        {draft.roughness}, [&](std::span<const Spectrum> v) { return Vec4{1, our_roughness(v[0].r, remap), 1, 1}; },
        false, false, draft.domain, draft.place);
    apply(roughness, m.metallic_roughness_texture, draft);
    m.roughness = roughness.texture ? 1.0f : roughness.value.y;
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
    if (power > 0 && area > 0 && mean > 0) scale *= power / (mean * (two_sided ? 2 : 1) * area * 3.14159265358979);
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
    if (!draft.visible) return {{}, {}, false, false};
    finish_textures(draft);
    out_.materials.push_back(std::move(draft.material));
    return {static_cast<MaterialId>(out_.materials.size() - 1), draft.mapping, true, draft.by_domain};
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
    const std::array<Vec2, 2> domain{Vec2{std::floor(uv_domain[0].x + 1e-4f), std::floor(uv_domain[0].y + 1e-4f)},
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
