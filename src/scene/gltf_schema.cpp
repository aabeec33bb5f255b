// SPDX-License-Identifier: Apache-2.0
// The part of glTF 2.0 that we read, as a table.
#include "scene/gltf_schema.hpp"

namespace relumine {
namespace {

using Kind = GltfKind;
using Field = GltfField;

constexpr double any_float = 3.4e38;      // what a float can hold
constexpr double any_size = 0x1p40;       // bytes
constexpr double any_int = 2147483647.0;  // TinyGLTF keeps integers in an int

constexpr Field integer(std::string_view name, double lower, double upper) {
    return {.kind = Kind::integer, .name = name, .lower = lower, .upper = upper};
}
constexpr Field number(std::string_view name, double lower = -any_float, double upper = any_float) {
    return {.kind = Kind::number, .name = name, .lower = lower, .upper = upper};
}
constexpr Field numbers(std::string_view name, std::size_t count) {
    return {.kind = Kind::numbers,
            .name = name,
            .lower = -any_float,
            .upper = any_float,
            .min_count = count,
            .max_count = count};
}
constexpr Field text(std::string_view name) { return {.kind = Kind::text, .name = name}; }
constexpr Field texts(std::string_view name) { return {.kind = Kind::texts, .name = name}; }
constexpr Field boolean(std::string_view name) { return {.kind = Kind::boolean, .name = name}; }
constexpr Field index_of(std::string_view target, std::string_view name) {
    return {.kind = Kind::index, .name = name, .target = target};
}
constexpr Field indices_of(std::string_view target, std::string_view name) {
    return {.kind = Kind::indices, .name = name, .target = target};
}
constexpr Field index_map_of(std::string_view target, std::string_view name) {
    return {.kind = Kind::index_map, .name = name, .target = target};
}
constexpr Field numbers_by_name(std::string_view name, double lower, double upper) {
    return {.kind = Kind::integer_map, .name = name, .lower = lower, .upper = upper};
}
template <std::size_t N>
constexpr Field object(std::string_view name, const Field (&fields)[N]) {
    return {.kind = Kind::object, .name = name, .fields = fields, .field_count = N};
}
template <std::size_t N>
constexpr Field objects(std::string_view name, const Field (&fields)[N]) {
    return {.kind = Kind::objects, .name = name, .fields = fields, .field_count = N};
}
constexpr Field required(Field field) {
    field.required = true;
    return field;
}

constexpr Field asset[] = {required(text("version")), text("minVersion")};

constexpr Field fallback_buffer[] = {boolean("fallback")};
constexpr Field buffer_extensions[] = {object("EXT_meshopt_compression", fallback_buffer)};
constexpr Field buffer[] = {
    text("name"),
    text("uri"),
    required(integer("byteLength", 1, any_size)),
    object("extensions", buffer_extensions),
};

constexpr Field meshopt_view[] = {
    required(index_of("/buffers", "buffer")),
    integer("byteOffset", 0, any_size),
    required(integer("byteLength", 1, any_size)),
    required(integer("byteStride", 2, 256)),
    required(integer("count", 1, any_int)),
    required(text("mode")),
    text("filter"),
};
constexpr Field buffer_view_extensions[] = {object("EXT_meshopt_compression", meshopt_view)};

constexpr Field buffer_view[] = {
    text("name"),
    required(index_of("/buffers", "buffer")),
    integer("byteOffset", 0, any_size),
    required(integer("byteLength", 1, any_size)),
    integer("byteStride", 4, 252),
    object("extensions", buffer_view_extensions),
};

constexpr Field sparse_indices[] = {
    required(index_of("/bufferViews", "bufferView")),
    integer("byteOffset", 0, any_int),
    required(integer("componentType", 5121, 5125)),
};
constexpr Field sparse_values[] = {
    required(index_of("/bufferViews", "bufferView")),
    integer("byteOffset", 0, any_int),
};
constexpr Field sparse[] = {
    required(integer("count", 1, any_int)),
    required(object("indices", sparse_indices)),
    required(object("values", sparse_values)),
};
constexpr Field accessor[] = {
    text("name"),
    index_of("/bufferViews", "bufferView"),
    integer("byteOffset", 0, any_size),
    required(integer("componentType", 5120, 5126)),
    boolean("normalized"),
    required(integer("count", 1, any_int)),
    required(text("type")),
    object("sparse", sparse),
};

constexpr Field image[] = {text("name"), text("uri"), text("mimeType"),
                           index_of("/bufferViews", "bufferView")};
constexpr Field sampler[] = {
    integer("magFilter", 9728, 9729),
    integer("wrapS", 10497, 33648),
    integer("wrapT", 10497, 33648),
};
constexpr Field texture_source[] = {index_of("/images", "source")};
constexpr Field texture_extensions[] = {object("EXT_texture_webp", texture_source)};
constexpr Field texture[] = {
    text("name"),
    index_of("/samplers", "sampler"),
    index_of("/images", "source"),
    object("extensions", texture_extensions),
};

constexpr Field texture_transform[] = {numbers("offset", 2), number("rotation"), numbers("scale", 2),
                                       integer("texCoord", 0, any_int)};
constexpr Field texture_info_extensions[] = {object("KHR_texture_transform", texture_transform)};
constexpr Field texture_info[] = {
    required(index_of("/textures", "index")),
    integer("texCoord", 0, any_int),
    object("extensions", texture_info_extensions),
};
constexpr Field normal_texture_info[] = {
    required(index_of("/textures", "index")),
    integer("texCoord", 0, any_int),
    number("scale"),
    object("extensions", texture_info_extensions),
};
constexpr Field metallic_roughness[] = {
    numbers("baseColorFactor", 4), object("baseColorTexture", texture_info),         number("metallicFactor"),
    number("roughnessFactor"),     object("metallicRoughnessTexture", texture_info),
};
constexpr Field emissive_strength[] = {number("emissiveStrength", 0)};
constexpr Field ior[] = {number("ior", 0)};
constexpr Field specular[] = {
    number("specularFactor"),
    object("specularTexture", texture_info),
    numbers("specularColorFactor", 3),
    object("specularColorTexture", texture_info),
};
constexpr Field transmission[] = {number("transmissionFactor"), object("transmissionTexture", texture_info)};
constexpr Field volume[] = {
    number("thicknessFactor", 0),
    object("thicknessTexture", texture_info),
    number("attenuationDistance", 0),
    numbers("attenuationColor", 3),
};
constexpr Field clearcoat[] = {
    number("clearcoatFactor"),
    object("clearcoatTexture", texture_info),
    number("clearcoatRoughnessFactor"),
    object("clearcoatRoughnessTexture", texture_info),
    object("clearcoatNormalTexture", normal_texture_info),
};
constexpr Field anisotropy[] = {
    number("anisotropyStrength"),
    number("anisotropyRotation"),
    object("anisotropyTexture", texture_info),
};
constexpr Field sheen[] = {
    numbers("sheenColorFactor", 3),
    object("sheenColorTexture", texture_info),
    number("sheenRoughnessFactor"),
    object("sheenRoughnessTexture", texture_info),
};
constexpr Field specular_glossiness[] = {
    numbers("diffuseFactor", 4),
    object("diffuseTexture", texture_info),
    numbers("specularFactor", 3),
    number("glossinessFactor"),
    object("specularGlossinessTexture", texture_info),
};
constexpr Field nothing[] = {text("name")};
constexpr Field material_extensions[] = {
    object("KHR_materials_anisotropy", anisotropy),
    object("KHR_materials_clearcoat", clearcoat),
    object("KHR_materials_pbrSpecularGlossiness", specular_glossiness),
    object("KHR_materials_sheen", sheen),
    object("KHR_materials_unlit", nothing),
    object("KHR_materials_emissive_strength", emissive_strength),
    object("KHR_materials_ior", ior),
    object("KHR_materials_specular", specular),
    object("KHR_materials_transmission", transmission),
    object("KHR_materials_volume", volume),
};
constexpr Field material[] = {
    text("name"),
    object("pbrMetallicRoughness", metallic_roughness),
    object("normalTexture", normal_texture_info),
    numbers("emissiveFactor", 3),
    object("emissiveTexture", texture_info),
    text("alphaMode"),
    number("alphaCutoff", 0),
    boolean("doubleSided"),
    object("extensions", material_extensions),
};

constexpr Field draco[] = {
    required(index_of("/bufferViews", "bufferView")),
    required(numbers_by_name("attributes", 0, any_int)),
};
constexpr Field primitive_extensions[] = {object("KHR_draco_mesh_compression", draco)};
constexpr Field primitive[] = {
    required(index_map_of("/accessors", "attributes")),
    index_of("/accessors", "indices"),
    index_of("/materials", "material"),
    integer("mode", 0, 6),
    object("extensions", primitive_extensions),
};
constexpr Field mesh[] = {text("name"), required(objects("primitives", primitive))};

constexpr std::string_view lights_pointer = "/extensions/KHR_lights_punctual/lights";
constexpr Field node_light[] = {required(index_of(lights_pointer, "light"))};
constexpr Field gpu_instancing[] = {required(index_map_of("/accessors", "attributes"))};
constexpr Field node_extensions[] = {
    object("EXT_mesh_gpu_instancing", gpu_instancing),
    object("KHR_lights_punctual", node_light),
};
constexpr Field node[] = {
    text("name"),
    indices_of("/nodes", "children"),
    numbers("matrix", 16),
    numbers("translation", 3),
    numbers("rotation", 4),
    numbers("scale", 3),
    index_of("/meshes", "mesh"),
    index_of("/cameras", "camera"),
    object("extensions", node_extensions),
};
constexpr Field scene[] = {text("name"), indices_of("/nodes", "nodes")};

constexpr double tiny = 1e-30, half_turn = 3.14159265358979324;
constexpr Field perspective[] = {
    required(number("yfov", tiny, half_turn)),
    number("aspectRatio", tiny),
    required(number("znear", 0)),
    number("zfar", 0),
};
constexpr Field orthographic[] = {
    required(number("xmag")),
    required(number("ymag")),
    required(number("znear")),
    required(number("zfar")),
};
constexpr Field camera[] = {
    text("name"),
    required(text("type")),
    object("perspective", perspective),
    object("orthographic", orthographic),
};

constexpr Field spot[] = {number("innerConeAngle", 0, half_turn / 2),
                          number("outerConeAngle", 0, half_turn / 2)};
constexpr Field light[] = {
    text("name"),           required(text("type")), numbers("color", 3),
    number("intensity", 0), number("range", 0),     object("spot", spot),
};
constexpr Field lights_punctual[] = {required(objects("lights", light))};
constexpr Field root_extensions[] = {object("KHR_lights_punctual", lights_punctual)};

constexpr Field root_fields[] = {
    required(object("asset", asset)),
    texts("extensionsUsed"),
    texts("extensionsRequired"),
    objects("buffers", buffer),
    objects("bufferViews", buffer_view),
    objects("accessors", accessor),
    objects("images", image),
    objects("samplers", sampler),
    objects("textures", texture),
    objects("materials", material),
    objects("meshes", mesh),
    objects("nodes", node),
    objects("scenes", scene),
    objects("cameras", camera),
    index_of("/scenes", "scene"),
    object("extensions", root_extensions),
};

}  // namespace

GltfField gltf_root() { return object("", root_fields); }

}  // namespace relumine
