// SPDX-License-Identifier: Apache-2.0
// Checks a JSON document against the table of gltf_schema.cpp.
#include <fmt/format.h>

#include <map>

#include "base/message.hpp"
#include "relumine/error.hpp"
#include "scene/gltf_schema.hpp"
#include "scene/quote.hpp"

namespace relumine {
namespace {

using nlohmann::json;

/// "3.5", "\"text\"" or "an array": what a message says was found.
std::string found_text(const json& value) {
    if (value.is_array()) return "an array";
    if (value.is_object()) return "an object";
    if (value.is_string()) return quote(value.get_ref<const std::string&>());
    return value.dump();
}

/// Knows the whole document, because indices are checked against the sizes of its arrays.
class Checker {
  public:
    Checker(const json& document, const std::string& file) : document_(document), file_(file) {}

    [[nodiscard]] json object(const json& value, const GltfField& field, const std::string& place) const {
        if (!value.is_object()) refuse(place, "an object", value);
        json copy = json::object();
        for (std::size_t i = 0; i < field.field_count; ++i) {
            const GltfField& member = field.fields[i];
            const std::string name{member.name};
            const auto it = value.find(name);
            const std::string member_place = fmt::format("{}{}{}", place, place.empty() ? "" : ".", name);
            if (it != value.end())
                copy[name] = checked(*it, member, member_place);
            else if (member.required)
                throw SceneError{expected_found(where(member_place), "a value", "nothing")};
        }
        return copy;
    }

  private:
    [[nodiscard]] std::string where(const std::string& place) const {
        return place.empty() ? file_ : file_ + ": " + place;
    }
    [[noreturn]] void refuse(const std::string& place, const std::string& expected, const json& found) const {
        throw SceneError{expected_found(where(place), expected, found_text(found))};
    }

    [[nodiscard]] std::size_t find_array_size(std::string_view pointer) const {
        const json::json_pointer target{std::string{pointer}};
        if (!document_.contains(target)) return 0;
        const json& array = document_.at(target);
        return array.is_array() ? array.size() : 0;
    }
    [[nodiscard]] std::size_t array_size(std::string_view pointer) const {
        const auto [it, inserted] = sizes_.try_emplace(pointer, 0);
        if (inserted) it->second = find_array_size(pointer);
        return it->second;
    }

    [[nodiscard]] json integer(const json& value, double lower, double upper,
                               const std::string& place) const {
        if (!value.is_number_integer()) refuse(place, "an integer", value);
        const auto number = value.get<double>();
        if (!(number >= lower && number <= upper))
            refuse(place, fmt::format("an integer from {:.0f} to {:.0f}", lower, upper), value);
        return value;
    }

    [[nodiscard]] json index(const json& value, const GltfField& field, const std::string& place) const {
        const std::size_t size = array_size(field.target);
        const std::string_view array = field.target.substr(field.target.rfind('/') + 1);
        if (!value.is_number_unsigned() || value.get<std::uint64_t>() >= size)
            refuse(place, fmt::format("an index of one of {} {}", size, array), value);
        return value;
    }

    [[nodiscard]] json number(const json& value, const GltfField& field, const std::string& place) const {
        if (!value.is_number()) refuse(place, "a number", value);
        const auto x = value.get<double>();
        if (!(x >= field.lower && x <= field.upper))
            refuse(place, fmt::format("a number from {:g} to {:g}", field.lower, field.upper), value);
        return x;
    }

    template <typename Check>
    [[nodiscard]] json array(const json& value, const GltfField& field, const std::string& place,
                             const Check& check) const {
        if (!value.is_array()) refuse(place, "an array", value);
        if (value.size() < field.min_count || value.size() > field.max_count)
            throw SceneError{expected_found(where(place), fmt::format("{} elements", field.min_count),
                                            fmt::format("{}", value.size()))};
        json copy = json::array();
        for (std::size_t i = 0; i < value.size(); ++i)
            copy.push_back(check(value[i], fmt::format("{}[{}]", place, i)));
        return copy;
    }

    [[nodiscard]] json index_map(const json& value, const GltfField& field, const std::string& place) const {
        if (!value.is_object()) refuse(place, "an object", value);
        json copy = json::object();
        for (const auto& [name, element] : value.items())
            copy[name] = index(element, field, place + '.' + quote(name));
        return copy;
    }

    [[nodiscard]] json integer_map(const json& value, const GltfField& field,
                                   const std::string& place) const {
        if (!value.is_object()) refuse(place, "an object", value);
        json copy = json::object();
        for (const auto& [name, element] : value.items())
            copy[name] = integer(element, field.lower, field.upper, place + '.' + quote(name));
        return copy;
    }

    [[nodiscard]] json string(const json& value, const std::string& place) const {
        if (!value.is_string()) refuse(place, "a string", value);
        return value;
    }

    [[nodiscard]] json checked(const json& value, const GltfField& field, const std::string& place) const {
        switch (field.kind) {
            case GltfKind::integer:
                return integer(value, field.lower, field.upper, place);
            case GltfKind::index:
                return index(value, field, place);
            case GltfKind::number:
                return number(value, field, place);
            case GltfKind::text:
                return string(value, place);
            case GltfKind::object:
                return object(value, field, place);
            case GltfKind::index_map:
                return index_map(value, field, place);
            case GltfKind::integer_map:
                return integer_map(value, field, place);
            case GltfKind::boolean:
                if (!value.is_boolean()) refuse(place, "true or false", value);
                return value;
            default:
                return checked_array(value, field, place);
        }
    }

    [[nodiscard]] json checked_array(const json& value, const GltfField& field,
                                     const std::string& place) const {
        return array(value, field, place, [&](const json& element, const std::string& element_place) {
            switch (field.kind) {
                case GltfKind::numbers:
                    return number(element, field, element_place);
                case GltfKind::indices:
                    return index(element, field, element_place);
                case GltfKind::texts:
                    return string(element, element_place);
                default:
                    return object(element, field, element_place);
            }
        });
    }

    const json& document_;
    const std::string& file_;
    mutable std::map<std::string_view, std::size_t> sizes_;  // what array_size() found, by pointer
};

}  // namespace

nlohmann::json checked_document(const nlohmann::json& document, const std::string& file) {
    return Checker{document, file}.object(document, gltf_root(), "");
}

}  // namespace relumine
