// SPDX-License-Identifier: Apache-2.0
// The JSON of a glTF file.
#include "scene/gltf_document.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "base/message.hpp"
#include "relumine/error.hpp"
#include "scene/gltf_schema.hpp"
#include "scene/quote.hpp"

namespace relumine {
namespace {

using nlohmann::json;

constexpr std::size_t max_json_bytes = std::size_t{1} << 28;
constexpr int max_depth = 64;  // glTF itself needs about ten; extras may need more

/// Exactly, or with a warning where a file uses a part that is approximated: docs/gltf.md.
constexpr std::array<std::string_view, 17> supported_extensions{
    "EXT_mesh_gpu_instancing",    "EXT_meshopt_compression",
    "EXT_texture_webp",           "KHR_draco_mesh_compression",
    "KHR_lights_punctual",        "KHR_materials_anisotropy",
    "KHR_materials_clearcoat",    "KHR_materials_emissive_strength",
    "KHR_materials_ior",          "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_sheen",        "KHR_materials_specular",
    "KHR_materials_transmission", "KHR_materials_unlit",
    "KHR_materials_volume",       "KHR_mesh_quantization",
    "KHR_texture_transform",
};

bool is_supported(std::string_view extension) {
    return std::ranges::find(supported_extensions, extension) != supported_extensions.end();
}

/// "file:line:column", both counted from 1; columns in bytes.
std::string position(std::span<const std::uint8_t> text, std::size_t at, const std::string& file) {
    const auto before = text.first(std::min(at, text.size()));
    const auto line = 1 + std::ranges::count(before, std::uint8_t{'\n'});
    const auto newline = std::find(before.rbegin(), before.rend(), std::uint8_t{'\n'});
    return fmt::format("{}:{}:{}", file, line, 1 + (newline - before.rbegin()));
}

/// Everything behind works recursively on the document, so its depth is bounded before it is parsed.
void check_depth(std::span<const std::uint8_t> text, const std::string& file) {
    int depth = 0;
    bool in_string = false;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const std::uint8_t c = text[i];
        if (in_string && c == '\\')
            ++i;
        else if (c == '"')
            in_string = !in_string;
        else if (!in_string && (c == '[' || c == '{') && ++depth > max_depth)
            throw SceneError{expected_found(position(text, i, file),
                                            fmt::format("at most {} nested values", max_depth), "more")};
        else if (!in_string && (c == ']' || c == '}'))
            --depth;
    }
}

/// The part of nlohmann's message behind "[json.exception…] … : ".
std::string reason(const json::exception& error) {
    const std::string_view message = error.what();
    const auto last_part = message.rfind("; ");
    const auto tag_end = message.find("] ");
    const std::size_t start = last_part != message.npos ? last_part + 2
                              : tag_end != message.npos ? tag_end + 2
                                                        : 0;
    return std::string{message.substr(start)};
}

json parse(std::span<const std::uint8_t> text, const std::string& file) {
    if (text.size() > max_json_bytes)
        throw SceneError{expected_found(file + ": JSON", fmt::format("at most {} bytes", max_json_bytes),
                                        fmt::format("{}", text.size()))};
    check_depth(text, file);
    try {
        return json::parse(text.begin(), text.end());
    } catch (const json::parse_error& error) {
        const std::size_t at = error.byte > 0 ? error.byte - 1 : 0;
        throw SceneError{expected_found(position(text, at, file), "valid JSON", quote(reason(error)))};
    } catch (const json::exception& error) {
        throw SceneError{expected_found(file, "valid JSON", quote(reason(error)))};
    }
}

void check_version(const json& document, const std::string& file) {
    const auto version = document["asset"]["version"].get<std::string>();
    if (version.substr(0, 2) != "2.")
        throw SceneError{expected_found(file + ": asset.version", "2.0", quote(version))};
    const auto minimum = document["asset"].value("minVersion", std::string{"2.0"});
    if (minimum != "2.0")
        throw SceneError{expected_found(file + ": asset.minVersion", "2.0", quote(minimum))};
}

void check_extensions(const json& document, const std::string& file, std::vector<std::string>& warnings) {
    for (const auto& extension : document.value("extensionsRequired", json::array())) {
        const auto& name = extension.get_ref<const std::string&>();
        if (!is_supported(name))
            throw SceneError{
                expected_found(file + ": extensionsRequired", "extensions that are supported", quote(name))};
    }
    for (const auto& extension : document.value("extensionsUsed", json::array())) {
        const auto& name = extension.get_ref<const std::string&>();
        if (!is_supported(name))
            warnings.push_back(fmt::format("extension {} is not supported and was ignored", quote(name)));
    }
}

std::string element_name(const json& element) {
    if (!element.is_object()) return "";
    const auto name = element.find("name");
    return name != element.end() && name->is_string() ? ' ' + quote(name->get_ref<const std::string&>()) : "";
}

/// One warning per element of the array `what`, such as "animations".
void warn_of_each(const json& document, const std::string& what, std::string_view consequence,
                  std::vector<std::string>& warnings) {
    const auto array = document.find(what);
    if (array == document.end() || !array->is_array()) return;
    for (std::size_t i = 0; i < std::min<std::size_t>(array->size(), 20); ++i)
        warnings.push_back(fmt::format("{}[{}]{}: {}", what, i, element_name((*array)[i]), consequence));
}

bool has_morph_targets(const json& mesh) {
    return std::ranges::any_of(mesh["primitives"],
                               [](const json& primitive) { return primitive.contains("targets"); });
}

void warn_of_morph_targets(const json& document, std::vector<std::string>& warnings) {
    const auto meshes = document.find("meshes");
    if (meshes == document.end()) return;
    for (std::size_t i = 0; i < meshes->size(); ++i)
        if (has_morph_targets((*meshes)[i]))
            warnings.push_back(
                fmt::format("meshes[{}]{}: morph targets are not supported; the base shape is used", i,
                            element_name((*meshes)[i])));
}

}  // namespace

nlohmann::json read_gltf_document(std::span<const std::uint8_t> text, const std::string& file,
                                  std::vector<std::string>& warnings) {
    const json document = parse(text, file);
    json checked = checked_document(document, file);
    check_version(checked, file);
    check_extensions(checked, file, warnings);
    warn_of_each(document, "animations", "animations are not supported; the rest pose is used", warnings);
    warn_of_each(document, "skins", "skins are not supported; the rest pose is used", warnings);
    warn_of_morph_targets(document, warnings);
    return checked;
}

}  // namespace relumine
