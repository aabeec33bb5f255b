// SPDX-License-Identifier: Apache-2.0
// pbrt's materials as our material: one function per kind.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/message.hpp"
#include "scene/pbrt_material_draft.hpp"
#include "scene/quote.hpp"

namespace relumine {

namespace {

const std::vector<std::string> material_types{
    "coatedconductor",     "coateddiffuse", "conductor", "dielectric", "diffuse",
    "diffusetransmission", "hair",          "interface", "measured",   "mix",
    "subsurface",          "thindielectric"};

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

double conductor_f0(double eta, double k) {
    return ((eta - 1) * (eta - 1) + k * k) / ((eta + 1) * (eta + 1) + k * k);
}

Spectrum per_channel(Spectrum a, Spectrum b, const std::function<double(double, double)>& f) {
    return {static_cast<float>(f(double{a.r}, double{b.r})), static_cast<float>(f(double{a.g}, double{b.g})),
            static_cast<float>(f(double{a.b}, double{b.b}))};
}

}  // namespace

CoatedAlbedo::CoatedAlbedo(double eta, double thickness, int bounces) : bounces_(bounces) {
    entering_ = 1 - diffuse_fresnel(eta);
    const double inside = 1 - entering_ / (eta * eta);
    const double critical = std::sqrt(std::max(0.0, 1 - 1 / (eta * eta)));
    const double straight = std::exp(-2 * thickness / (1 + critical));  // one way through, inside the cone
    const double there_and_back = critical > 0 ? std::exp(-4 * thickness / critical) : 1;  // outside of it
    through_ = straight * straight / (eta * eta);
    trapped_ = inside * there_and_back;
}

float CoatedAlbedo::base(float albedo) const {
    const double a = std::clamp(double{albedo}, 0.0, 1.0), again = a * trapped_;
    return static_cast<float>(
        std::min(1.0, entering_ * a * through_ * (1 - std::pow(again, bounces_)) / (1 - again)));
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
        scene_.warn(p.place(),
                    fmt::format("bump mapping (\"displacement\" of {}) is not supported", quote(draft.type)));
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
    draft.roughness_v = is_constant(u) && is_constant(v) && u->value == v->value ? nullptr : v;
    if (u == v) draft.roughness_v = nullptr;
}

double PbrtMaterials::read_eta(const PbrtParameters& p, std::string_view name) {
    double eta = 1.5;
    if (const PbrtNodeRef number = textures_.number_or_null(p, name)) {
        if (is_constant(number))
            eta = double{number->value.r};
        else
            scene_.warn(p.place(), fmt::format("a texture for {} is read as 1.5", quote(name)));
    } else if (const PbrtNodeRef spectrum = textures_.spectrum_or_null(p, name, PbrtSpectrumUse::unbounded)) {
        const Spectrum v = spectrum->value;
        if (is_constant(spectrum)) eta = (double{v.r} + double{v.g} + double{v.b}) / 3;
    }
    if (!(eta > 0)) p.refuse(name, "an index of refraction above 0", fmt::format("{:g}", eta));
    return eta;
}

void PbrtMaterials::diffuse(const PbrtEntity& entity, Draft& draft) {
    draft.color =
        textures_.spectrum(entity.parameters, "reflectance", Spectrum{0.5f}, PbrtSpectrumUse::albedo);
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
    const int depth = std::clamp(p.integer("maxdepth", 10), 1, 1000);
    p.ignore({"nsamples", "g"});
    if (p.has("albedo")) scene_.warn(p.place(), "a medium inside the coat (\"albedo\") is not supported");
    p.ignore({"albedo"});
    const double thick = is_constant(thickness) ? std::max(0.0, double{thickness->value.r}) : 0.01;
    const CoatedAlbedo coat(std::max(eta, 1.0), thick, (depth + 1) / 2);
    draft.recolor = [coat](Spectrum c) { return Spectrum{coat.base(c.r), coat.base(c.g), coat.base(c.b)}; };
    draft.material.coated_diffuse = true;
    draft.material.specular = static_cast<float>(coat.entering());
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
    const PbrtNodeRef eta =
        textures_.spectrum(p, "eta", {.1071f, .9772f, 1.2047f}, PbrtSpectrumUse::unbounded);
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
    draft.color =
        reflectance ? reflectance : constant_node(per_channel(eta->value, k->value, [&](double n, double kk) {
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
        eta = 1 / eta;
        draft.inside_out = !thin;
    }
    draft.color = constant_node(Spectrum{1});
    draft.material.metallic = 0;
    draft.material.transmission = 1;
    draft.material.solid = !thin;
    draft.material.ior = static_cast<float>(eta);
}

void PbrtMaterials::diffuse_transmission(const PbrtEntity& entity, Draft& draft) {
    const PbrtParameters& p = entity.parameters;
    draft.color = textures_.spectrum(p, "reflectance", Spectrum{0.25f}, PbrtSpectrumUse::albedo);
    draft.transmittance = textures_.spectrum(p, "transmittance", Spectrum{0.25f}, PbrtSpectrumUse::albedo);
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
    const auto is_matte = [](const Draft& d) {
        return d.material.metallic == 0 && d.material.specular == 0 && !d.transmittance && !d.normal;
    };
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
    draft.roughness_v = main.roughness_v;
    draft.transmittance = main.transmittance;
    draft.normal = main.normal;
    if (a.coated_diffuse != b.coated_diffuse || main.transmittance) return;  // the one of the larger share
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
    if (draft.roughness) return;
    const Draft& rough = parts[0].roughness ? parts[0] : parts[1];
    draft.roughness = rough.roughness;
    draft.roughness_v = rough.roughness_v;
}

void PbrtMaterials::unsupported(const PbrtEntity& entity, Draft& draft) {
    scene_.warn(entity.parameters.place(),
                fmt::format("material {} is not supported: a grey diffuse one instead", quote(entity.type)));
    const PbrtNodeRef color = entity.type == "subsurface" ? textures_.spectrum_or_null(
                                  entity.parameters, "reflectance", PbrtSpectrumUse::albedo)
                                                          : nullptr;
    if (color) draft.color = color;
    entity.parameters.ignore({"mfp",        "mfree",          "sigma_a",     "sigma_s",   "name",
                              "g",          "scale",          "eta",         "roughness", "uroughness",
                              "vroughness", "remaproughness", "reflectance", "filename",  "color",
                              "eumelanin",  "pheomelanin",    "beta_m",      "beta_n",    "alpha"});
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

}  // namespace relumine
