// SPDX-License-Identifier: Apache-2.0
// The part of glTF 2.0 that we read, as a table; checks a JSON document against it and drops everything else.
#pragma once

#include <cstddef>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

namespace relumine {

enum class GltfKind {
    integer,  // in [lower, upper]
    index,    // of an element of the array `target`
    number,   // in [lower, upper]
    text,
    boolean,
    object,       // with `fields`
    numbers,      // array of numbers, `min_count` to `max_count`
    indices,      // array of indices of `target`
    texts,        // array of strings
    objects,      // array of objects with `fields`
    index_map,    // object whose values are indices of `target`
    integer_map,  // object whose values are integers in [lower, upper]
};

/// One property of a JSON object.
struct GltfField {
    GltfKind kind;
    std::string_view name;
    bool required = false;
    double lower = 0, upper = 0;
    std::string_view target{};  // JSON pointer, e.g. "/accessors"
    std::size_t min_count = 0, max_count = std::numeric_limits<std::size_t>::max();
    const GltfField* fields = nullptr;  // an array in static memory
    std::size_t field_count = 0;
};

/// The fields of a glTF file's root object.
[[nodiscard]] GltfField gltf_root();

/// A copy of `document` that holds nothing but what the table names, each value of the right type and range;
/// numbers become floating-point values. Throws SceneError with the place, e.g. "kitchen.glb:
/// accessors[3].count: expected …".
[[nodiscard]] nlohmann::json checked_document(const nlohmann::json& document, const std::string& file);

}  // namespace relumine
