// SPDX-License-Identifier: Apache-2.0
// Materials and textures of a glTF file.
#include "scene/gltf_material.hpp"

#include <fmt/format.h>

#include <cmath>
#include <map>

#include "base/message.hpp"
#include "relumine/error.hpp"
#include "scene/gltf_image.hpp"
#include "scene/quote.hpp"

namespace relumine {
namespace {

using tinygltf::Value;

/// A member of an extension object, or null.
const Value* member(const Value* object, const std::string& name) {
    return object != nullptr && object->Has(name) ? &object->Get(name) : nullptr;
}

const Value* extension(const tinygltf::ExtensionMap& extensions, const std::string& name) {
    const auto it = extensions.find(name);
    return it == extensions.end() ? nullptr : &it->second;
}

double number_or(const Value* object, const std::string& name, double fallback) {
    const Value* value = member(object, name);
    return value != nullptr && value->IsNumber() ? value->GetNumberAsDouble() : fallback;
}

/// Element `i` of the array `name`.
float element_or(const Value* object, const std::string& name, int i, float fallback) {
    const Value* array = member(object, name);
    return array != nullptr && array->IsArray() ? static_cast<float>(array->Get(i).GetNumberAsDouble())
                                                : fallback;
}

Spectrum color_or_white(const Value* object, const std::string& name) {
    return {element_or(object, name, 0, 1), element_or(object, name, 1, 1), element_or(object, name, 2, 1)};
}

Spectrum spectrum(const std::vector<double>& rgb) {
    return {static_cast<float>(rgb[0]), static_cast<float>(rgb[1]), static_cast<float>(rgb[2])};
}

/// A texture as a material names it, from whichever of TinyGLTF's types.
struct TextureUse {
    int texture = -1;  // −1: none
    int uv_set = 0;
    const Value* transform = nullptr;  // KHR_texture_transform
    std::string place;                 // for messages
};

/// Translation · rotation · scale; a positive angle turns counter-clockwise as seen on the picture, whose v
/// grows downwards, so that (1, 0) goes to (cos, −sin).
std::array<float, 6> uv_transform(const Value* transform) {
    const double angle = number_or(transform, "rotation", 0);
    const auto c = static_cast<float>(std::cos(angle)), s = static_cast<float>(std::sin(angle));
    const float scale_u = element_or(transform, "scale", 0, 1),
                scale_v = element_or(transform, "scale", 1, 1);
    return {c * scale_u,  s * scale_v, element_or(transform, "offset", 0, 0),
            -s * scale_u, c * scale_v, element_or(transform, "offset", 1, 0)};
}

/// Reads the materials of one file.
class MaterialReader {
  public:
    MaterialReader(const GltfFile& file, SceneData& scene) : file_(file), scene_(scene) {}

    [[nodiscard]] Material read(std::size_t i);
    [[nodiscard]] std::vector<int> used_images() const { return images_; }

  private:
    void read_metallic_roughness(const tinygltf::PbrMetallicRoughness& source, Material& material);
    void read_alpha(const tinygltf::Material& source, Material& material) const;
    void read_specular(const Value* specular, Material& material);
    void read_refraction(const tinygltf::ExtensionMap& extensions, Material& material);
    void read_anisotropy(const Value* anisotropy, Material& material);
    void read_clearcoat(const Value* clearcoat, Material& material);
    void read_sheen(const Value* sheen, Material& material);
    void read_specular_glossiness(const Value* source, Material& material);
    void make_unlit(Material& material);

    template <typename Info>
    std::optional<TextureRef> texture(const Info& info, const std::string& name) {
        return texture(TextureUse{info.index, info.texCoord,
                                  extension(info.extensions, "KHR_texture_transform"), place_ + '.' + name});
    }
    std::optional<TextureRef> texture(const Value* object, const std::string& name) {
        const Value* info = member(object, name);
        if (info == nullptr) return std::nullopt;
        return texture(TextureUse{
            static_cast<int>(number_or(info, "index", -1)), static_cast<int>(number_or(info, "texCoord", 0)),
            member(member(info, "extensions"), "KHR_texture_transform"), place_ + '.' + name});
    }
    std::optional<TextureRef> texture(const TextureUse& use);
    [[nodiscard]] int uv_set(const TextureUse& use) const;
    void apply_sampler(int sampler, TextureRef& ref) const;
    [[nodiscard]] Wrap wrap(int sampler, int mode) const;
    [[nodiscard]] ImageId image(int source);

    const GltfFile& file_;
    SceneData& scene_;
    std::string place_;           // "materials[3]"
    std::vector<int> images_;     // by ImageId: which of the file's images
    std::map<int, ImageId> ids_;  // the inverse
};

Material MaterialReader::read(std::size_t i) {
    const auto& source = file_.model.materials[i];
    place_ = fmt::format("materials[{}]", i);
    Material material;
    material.name = source.name.empty() ? fmt::format("material {}", i) : source.name;
    read_metallic_roughness(source.pbrMetallicRoughness, material);
    material.normal_texture = texture(source.normalTexture, "normalTexture");
    material.normal_scale = static_cast<float>(source.normalTexture.scale);
    const Value* strength = extension(source.extensions, "KHR_materials_emissive_strength");
    material.emission =
        spectrum(source.emissiveFactor) * static_cast<float>(number_or(strength, "emissiveStrength", 1));
    material.emission_texture = texture(source.emissiveTexture, "emissiveTexture");
    material.double_sided = source.doubleSided;
    read_alpha(source, material);
    read_specular(extension(source.extensions, "KHR_materials_specular"), material);
    read_refraction(source.extensions, material);
    read_anisotropy(extension(source.extensions, "KHR_materials_anisotropy"), material);
    read_clearcoat(extension(source.extensions, "KHR_materials_clearcoat"), material);
    read_sheen(extension(source.extensions, "KHR_materials_sheen"), material);
    if (const Value* gloss = extension(source.extensions, "KHR_materials_pbrSpecularGlossiness"))
        read_specular_glossiness(gloss, material);
    if (extension(source.extensions, "KHR_materials_unlit") != nullptr) make_unlit(material);
    return material;
}

void MaterialReader::read_metallic_roughness(const tinygltf::PbrMetallicRoughness& source,
                                             Material& material) {
    material.base_color = spectrum(source.baseColorFactor);
    material.base_alpha = static_cast<float>(source.baseColorFactor[3]);
    material.base_color_texture = texture(source.baseColorTexture, "pbrMetallicRoughness.baseColorTexture");
    material.metallic = static_cast<float>(source.metallicFactor);
    material.roughness = static_cast<float>(source.roughnessFactor);
    material.metallic_roughness_texture =
        texture(source.metallicRoughnessTexture, "pbrMetallicRoughness.metallicRoughnessTexture");
}

void MaterialReader::read_alpha(const tinygltf::Material& source, Material& material) const {
    material.alpha_cutoff = static_cast<float>(source.alphaCutoff);
    if (source.alphaMode == "OPAQUE")
        material.alpha_mode = AlphaMode::opaque;
    else if (source.alphaMode == "MASK")
        material.alpha_mode = AlphaMode::mask;
    else if (source.alphaMode == "BLEND")
        material.alpha_mode = AlphaMode::blend;
    else
        throw SceneError{expected_found(file_.where(place_ + ".alphaMode"), "OPAQUE, MASK or BLEND",
                                        quote(source.alphaMode))};
}

void MaterialReader::read_specular(const Value* specular, Material& material) {
    material.specular = static_cast<float>(number_or(specular, "specularFactor", 1));
    material.specular_texture = texture(specular, "specularTexture");
    material.specular_color = color_or_white(specular, "specularColorFactor");
    material.specular_color_texture = texture(specular, "specularColorTexture");
}

/// KHR_materials_ior, _transmission and _volume. A volume's thickness only tells solid from sheet: paths find
/// the rest.
void MaterialReader::read_refraction(const tinygltf::ExtensionMap& extensions, Material& material) {
    material.ior = static_cast<float>(number_or(extension(extensions, "KHR_materials_ior"), "ior", 1.5));
    if (material.ior == 0) {  // by the extension: a surface that reflects everything
        material.ior = 1000;
        scene_.warn(
            fmt::format("{} {}: ior 0 is rendered as {}", place_, quote(material.name), material.ior));
    }
    const Value* transmission = extension(extensions, "KHR_materials_transmission");
    material.transmission = static_cast<float>(number_or(transmission, "transmissionFactor", 0));
    material.transmission_texture = texture(transmission, "transmissionTexture");
    const Value* volume = extension(extensions, "KHR_materials_volume");
    material.solid = number_or(volume, "thicknessFactor", 0) > 0;
    material.attenuation_color = color_or_white(volume, "attenuationColor");
    const double distance = number_or(volume, "attenuationDistance", 0);
    if (distance > 0) material.attenuation_distance = static_cast<float>(distance);
}

void MaterialReader::read_anisotropy(const Value* anisotropy, Material& material) {
    material.anisotropy = static_cast<float>(number_or(anisotropy, "anisotropyStrength", 0));
    material.anisotropy_rotation = static_cast<float>(number_or(anisotropy, "anisotropyRotation", 0));
    material.anisotropy_texture = texture(anisotropy, "anisotropyTexture");
}

void MaterialReader::read_clearcoat(const Value* clearcoat, Material& material) {
    material.clearcoat = static_cast<float>(number_or(clearcoat, "clearcoatFactor", 0));
    material.clearcoat_texture = texture(clearcoat, "clearcoatTexture");
    material.clearcoat_roughness = static_cast<float>(number_or(clearcoat, "clearcoatRoughnessFactor", 0));
    material.clearcoat_roughness_texture = texture(clearcoat, "clearcoatRoughnessTexture");
    if (material.clearcoat > 0 && (member(clearcoat, "clearcoatNormalTexture") || material.normal_texture))
        scene_.warn(fmt::format("{} {}: the clear coat has the normals of what is below it", place_,
                                quote(material.name)));
}

void MaterialReader::read_sheen(const Value* sheen, Material& material) {
    for (int i = 0; i < 3; ++i) {
        float* const channel[] = {&material.sheen_color.r, &material.sheen_color.g, &material.sheen_color.b};
        *channel[i] = element_or(sheen, "sheenColorFactor", i, 0);
    }
    material.sheen_color_texture = texture(sheen, "sheenColorTexture");
    material.sheen_roughness = static_cast<float>(number_or(sheen, "sheenRoughnessFactor", 0));
    material.sheen_roughness_texture = texture(sheen, "sheenRoughnessTexture");
}

/// A diffuse base under a coat of any reflectance: the specular colour over an index that reflects
/// everything.
void MaterialReader::read_specular_glossiness(const Value* source, Material& material) {
    material.base_color = color_or_white(source, "diffuseFactor");
    material.base_alpha = element_or(source, "diffuseFactor", 3, 1);
    material.base_color_texture = texture(source, "diffuseTexture");
    material.metallic = 0;
    material.metallic_roughness_texture.reset();
    material.roughness = 1 - static_cast<float>(number_or(source, "glossinessFactor", 1));
    material.ior = 1e4f;  // F0 = 0.9996
    material.specular_color = color_or_white(source, "specularFactor");
    material.specular_color_texture = texture(source, "specularGlossinessTexture");
    if (material.specular_color_texture)
        scene_.warn(fmt::format("{} {}: the glossiness in the texture's alpha is ignored, the factor counts",
                                place_, quote(material.name)));
}

/// Shows the base colour whatever the light.
void MaterialReader::make_unlit(Material& material) {
    material.emission = material.base_color;
    material.emission_texture = material.base_color_texture;
    material.double_sided = true;
    material.base_color = {};
    material.metallic = material.specular = material.transmission = material.clearcoat = 0;
    material.sheen_color = {};
    scene_.warn(
        fmt::format("{} {}: unlit surfaces are rendered as emitting their base colour, and so light others",
                    place_, quote(material.name)));
}

std::optional<TextureRef> MaterialReader::texture(const TextureUse& use) {
    if (use.texture < 0) return std::nullopt;
    const auto& source = file_.model.textures[to_size(use.texture)];
    const Value* webp = extension(source.extensions, "EXT_texture_webp");
    const int picture = static_cast<int>(number_or(webp, "source", source.source));
    if (picture < 0) {
        scene_.warn(fmt::format("{}: textures[{}] has no PNG, JPEG or WebP image and was ignored", use.place,
                                use.texture));
        return std::nullopt;
    }
    TextureRef ref;
    ref.image = image(picture);
    ref.uv_set = uv_set(use);
    ref.uv_transform = uv_transform(use.transform);
    apply_sampler(source.sampler, ref);
    return ref;
}

int MaterialReader::uv_set(const TextureUse& use) const {
    const int set = static_cast<int>(number_or(use.transform, "texCoord", use.uv_set));
    if (set <= 1) return set;
    scene_.warn(fmt::format("{}: TEXCOORD_{} is not supported; TEXCOORD_0 is used", use.place, set));
    return 0;
}

void MaterialReader::apply_sampler(int sampler, TextureRef& ref) const {
    if (sampler < 0) return;
    const auto& source = file_.model.samplers[to_size(sampler)];
    ref.wrap_u = wrap(sampler, source.wrapS);
    ref.wrap_v = wrap(sampler, source.wrapT);
    ref.nearest = source.magFilter == TINYGLTF_TEXTURE_FILTER_NEAREST;
}

Wrap MaterialReader::wrap(int sampler, int mode) const {
    switch (mode) {
        case TINYGLTF_TEXTURE_WRAP_REPEAT:
            return Wrap::repeat;
        case TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE:
            return Wrap::clamp;
        case TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT:
            return Wrap::mirror;
        default:
            throw SceneError{expected_found(file_.where(fmt::format("samplers[{}]: wrap mode", sampler)),
                                            "10497, 33071 or 33648", fmt::format("{}", mode))};
    }
}

ImageId MaterialReader::image(int source) {
    const auto [it, inserted] = ids_.try_emplace(source, static_cast<ImageId>(images_.size()));
    if (inserted) images_.push_back(source);
    return it->second;
}

}  // namespace

void read_gltf_materials(const GltfFile& file, std::uint64_t texture_limit, SceneData& scene) {
    MaterialReader reader{file, scene};
    for (std::size_t i = 0; i < file.model.materials.size(); ++i) scene.materials.push_back(reader.read(i));
    TextureBudget budget(texture_limit);
    scene.images = decode_gltf_images(file, reader.used_images(), budget);
    if (std::string warning = budget.warning(); !warning.empty()) scene.warn(std::move(warning));
}

}  // namespace relumine
