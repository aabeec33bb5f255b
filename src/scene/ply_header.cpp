// SPDX-License-Identifier: Apache-2.0
// The header of a PLY file.
#include "scene/ply_header.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <optional>
#include <string_view>
#include <utility>

#include "base/message.hpp"
#include "relumine/error.hpp"
#include "scene/quote.hpp"

namespace relumine {
namespace {

using Words = std::vector<std::string_view>;

Words split(std::string_view line) {
    constexpr std::string_view space = " \t\r";
    Words words;
    for (std::size_t at = line.find_first_not_of(space); at != line.npos;
         at = line.find_first_not_of(space, at)) {
        const std::size_t end = std::min(line.find_first_of(space, at), line.size());
        words.push_back(line.substr(at, end - at));
        at = end;
    }
    return words;
}

std::optional<PlyType> find_type(std::string_view name) {
    using enum PlyType;
    constexpr std::array<std::pair<std::string_view, PlyType>, 16> types{{
        {"char", int8},
        {"int8", int8},
        {"uchar", uint8},
        {"uint8", uint8},
        {"short", int16},
        {"int16", int16},
        {"ushort", uint16},
        {"uint16", uint16},
        {"int", int32},
        {"int32", int32},
        {"uint", uint32},
        {"uint32", uint32},
        {"float", float32},
        {"float32", float32},
        {"double", float64},
        {"float64", float64},
    }};
    for (const auto& [type_name, type] : types)
        if (type_name == name) return type;
    return std::nullopt;
}

/// Reads the header line by line.
class HeaderParser {
  public:
    HeaderParser(std::span<const std::uint8_t> bytes, const std::string& path) : bytes_(bytes), path_(path) {}

    [[nodiscard]] PlyHeader parse() {
        if (next_line() != "ply") refuse("\"ply\"", "something else");
        parse_format(split(next_line()));
        for (auto words = split(next_line()); words != Words{"end_header"}; words = split(next_line()))
            parse_line(words);
        header_.body = at_;
        return std::move(header_);
    }

  private:
    [[noreturn]] void refuse(const std::string& expected, const std::string& found) const {
        throw SceneError{expected_found(fmt::format("{}:{}", path_, line_), expected, found)};
    }

    std::string_view next_line() {
        constexpr std::size_t longest = 4096;  // bytes
        ++line_;
        const auto rest = bytes_.subspan(at_).first(std::min(longest, bytes_.size() - at_));
        const auto newline = std::ranges::find(rest, std::uint8_t{'\n'});
        if (newline == rest.end()) refuse("a line of a PLY header", "none");
        const auto length = static_cast<std::size_t>(newline - rest.begin());
        at_ += length + 1;
        std::string_view line{reinterpret_cast<const char*>(rest.data()), length};
        while (line.ends_with('\r') || line.ends_with(' ')) line.remove_suffix(1);
        return line;
    }

    void parse_format(const Words& words) {
        if (words.size() != 3 || words[0] != "format" || words[2] != "1.0")
            refuse("\"format … 1.0\"", words.empty() ? "an empty line" : quote(words.back()));
        if (words[1] == "ascii")
            header_.format = PlyFormat::ascii;
        else if (words[1] == "binary_little_endian")
            header_.format = PlyFormat::little_endian;
        else if (words[1] == "binary_big_endian")
            header_.format = PlyFormat::big_endian;
        else
            refuse("ascii, binary_little_endian or binary_big_endian", quote(words[1]));
    }

    void parse_line(const Words& words) {
        if (words.empty() || words[0] == "comment" || words[0] == "obj_info") return;
        if (words[0] == "element")
            parse_element(words);
        else if (words[0] == "property")
            parse_property(words);
        else
            refuse("element, property, comment or end_header", quote(words[0]));
    }

    void parse_element(const Words& words) {
        constexpr std::size_t most_elements = 64;
        if (words.size() != 3) refuse("\"element NAME COUNT\"", fmt::format("{} words", words.size()));
        if (header_.elements.size() == most_elements) refuse("at most 64 elements", "more");
        PlyElement element{std::string{words[1]}, 0, {}};
        const std::string_view count = words[2];
        const auto [end, error] = std::from_chars(count.data(), count.data() + count.size(), element.count);
        if (error != std::errc{} || end != count.data() + count.size())
            refuse("a number of elements of at least 0", quote(count));
        header_.elements.push_back(std::move(element));
    }

    void parse_property(const Words& words) {
        constexpr std::size_t most_properties = 256;
        if (header_.elements.empty()) refuse("an element before its properties", "a property");
        auto& properties = header_.elements.back().properties;
        if (properties.size() == most_properties) refuse("at most 256 properties", "more");
        const bool list = words.size() > 1 && words[1] == "list";
        if (words.size() != (list ? 5u : 3u))
            refuse("\"property TYPE NAME\" or \"property list TYPE TYPE NAME\"",
                   fmt::format("{} words", words.size()));
        PlyProperty property{std::string{words.back()}, type(words[words.size() - 2]), list, PlyType::uint8};
        if (list) property.count_type = type(words[2]);
        if (property.count_type == PlyType::float32 || property.count_type == PlyType::float64)
            refuse("an integer type for a list's length", quote(words[2]));
        properties.push_back(std::move(property));
    }

    [[nodiscard]] PlyType type(std::string_view name) const {
        const auto type = find_type(name);
        if (!type) refuse("a type such as uchar, int or float", quote(name));
        return *type;
    }

    std::span<const std::uint8_t> bytes_;
    const std::string& path_;
    std::size_t at_ = 0;
    int line_ = 0;
    PlyHeader header_;
};

}  // namespace

PlyHeader parse_ply_header(std::span<const std::uint8_t> bytes, const std::string& path) {
    return HeaderParser{bytes, path}.parse();
}

std::size_t ply_type_size(PlyType type) {
    switch (type) {
        case PlyType::int8:
        case PlyType::uint8:
            return 1;
        case PlyType::int16:
        case PlyType::uint16:
            return 2;
        case PlyType::float64:
            return 8;
        default:
            return 4;
    }
}

}  // namespace relumine
