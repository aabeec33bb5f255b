// SPDX-License-Identifier: Apache-2.0
// Ranges of material values.
#include "scene/check_material.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/message.hpp"
#include "relumine/error.hpp"
#include "scene/quote.hpp"

namespace relumine {
namespace {

constexpr float rounding = 1e-4f;  // exporters that compute in half or 8-bit overshoot by less

/// Checks the values of one material.
class MaterialChecker {
  public:
    MaterialChecker(Material& material, const SceneData& scene) : material_(material), scene_(scene) {}

    void check() const;

  private:
    [[noreturn]] void refuse(std::string_view what, const std::string& expected,
                             const std::string& found) const {
        throw SceneError{expected_found(fmt::format("{}: material {}", scene_.name, quote(material_.name)),
                                        fmt::format("{} {}", what, expected), found)};
    }
    void factor(float& value, std::string_view what) const {  // in [0, 1]
        if (!(value >= -rounding && value <= 1 + rounding))
            refuse(what, "in [0, 1]", fmt::format("{:g}", value));
        value = std::clamp(value, 0.0f, 1.0f);
    }
    void factor(Spectrum& color, std::string_view what) const {
        factor(color.r, what);
        factor(color.g, what);
        factor(color.b, what);
    }
    void at_least(float value, float lower, std::string_view what) const {
        if (!(value >= lower) || !std::isfinite(value))
            refuse(what, fmt::format("of at least {:g}", lower), fmt::format("{:g}", value));
    }
    void texture(const std::optional<TextureRef>& ref, std::string_view what) const;
    void factors() const;
    void textures() const;

    Material& material_;
    const SceneData& scene_;
};

void MaterialChecker::check() const {
    factors();
    textures();
    at_least(material_.ior, 1, "ior");
    at_least(material_.alpha_cutoff, 0, "alpha cutoff");
    at_least(material_.emission.r, 0, "emission");
    at_least(material_.emission.g, 0, "emission");
    at_least(material_.emission.b, 0, "emission");
    if (!std::isfinite(material_.anisotropy_rotation))
        refuse("anisotropy rotation", "finite", "NaN or infinity");
    if (!std::isfinite(material_.normal_scale)) refuse("normal scale", "finite", "NaN or infinity");
    if (!(material_.attenuation_distance > 0))
        refuse("attenuation distance", "above 0", fmt::format("{:g}", material_.attenuation_distance));
}

void MaterialChecker::factors() const {
    factor(material_.base_color, "base colour");
    factor(material_.base_alpha, "alpha");
    factor(material_.metallic, "metallic");
    factor(material_.roughness, "roughness");
    factor(material_.anisotropy, "anisotropy");
    factor(material_.specular, "specular");
    factor(material_.transmission, "transmission");
    factor(material_.attenuation_color, "attenuation colour");
    factor(material_.diffuse_transmission, "diffuse transmission");
    factor(material_.clearcoat, "clearcoat");
    factor(material_.clearcoat_roughness, "clearcoat roughness");
    factor(material_.sheen_color, "sheen colour");
    factor(material_.sheen_roughness, "sheen roughness");
    // KHR_materials_specular lets the colour exceed 1; the reflectance that it scales is clamped when shading
    at_least(std::min({material_.specular_color.r, material_.specular_color.g, material_.specular_color.b}),
             0, "specular colour");
    at_least(max_component(material_.specular_color), 0, "specular colour");
}

void MaterialChecker::textures() const {
    texture(material_.base_color_texture, "base colour texture");
    texture(material_.metallic_roughness_texture, "metallic-roughness texture");
    texture(material_.anisotropy_texture, "anisotropy texture");
    texture(material_.normal_texture, "normal texture");
    texture(material_.emission_texture, "emission texture");
    texture(material_.specular_texture, "specular texture");
    texture(material_.specular_color_texture, "specular colour texture");
    texture(material_.transmission_texture, "transmission texture");
    texture(material_.diffuse_transmission_texture, "diffuse transmission texture");
    texture(material_.clearcoat_texture, "clearcoat texture");
    texture(material_.clearcoat_roughness_texture, "clearcoat roughness texture");
    texture(material_.sheen_color_texture, "sheen colour texture");
    texture(material_.sheen_roughness_texture, "sheen roughness texture");
}

void MaterialChecker::texture(const std::optional<TextureRef>& ref, std::string_view what) const {
    if (!ref) return;
    if (index(ref->image) >= scene_.images.size())
        refuse(what, fmt::format("below {}", scene_.images.size()), fmt::format("{}", index(ref->image)));
    if (ref->turned_away && index(*ref->turned_away) >= scene_.images.size())
        refuse(what, fmt::format("below {}", scene_.images.size()),
               fmt::format("{}", index(*ref->turned_away)));
    if (ref->uv_set != 0 && ref->uv_set != 1)
        refuse(what, "with UV set 0 or 1", fmt::format("set {}", ref->uv_set));
    if (!std::ranges::all_of(ref->uv_transform, [](float x) { return std::isfinite(x); }))
        refuse(what, "with a finite UV transform", "NaN or infinity");
}

}  // namespace

void check_materials(SceneData& scene) {
    for (Material& material : scene.materials) MaterialChecker{material, scene}.check();
}

bool is_radiance(Spectrum s) { return is_finite(s) && s.r >= 0 && s.g >= 0 && s.b >= 0; }

}  // namespace relumine
