// SPDX-License-Identifier: Apache-2.0
// What a scene file refers to by URI.
#include "scene/reference.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <string_view>
#include <system_error>

#include "base/message.hpp"
#include "relumine/error.hpp"
#include "scene/quote.hpp"

namespace relumine {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const std::string& where, const std::string& expected, const std::string& found) {
    throw SceneError{expected_found(where, expected, found)};
}

int hex_digit(char c) {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    if (c >= 'A' && c <= 'F') return c - 'A' + 10;
    return -1;
}

/// "%20" becomes a space. Refuses incomplete escapes and the zero byte, which would end a path early.
std::string percent_decoded(std::string_view uri, const std::string& where) {
    std::string text;
    for (std::size_t i = 0; i < uri.size(); ++i) {
        char c = uri[i];
        if (c == '%') {
            const int high = i + 2 < uri.size() ? hex_digit(uri[i + 1]) : -1;
            const int low = i + 2 < uri.size() ? hex_digit(uri[i + 2]) : -1;
            if (high < 0 || low < 0) refuse(where, "two hexadecimal digits after %", quote(uri));
            c = static_cast<char>(high * 16 + low);
            i += 2;
        }
        if (c == '\0') refuse(where, "a file name", "a name with a zero byte");
        text += c;
    }
    return text;
}

constexpr std::array<int, 256> base64_values = [] {
    std::array<int, 256> values{};
    values.fill(-1);
    constexpr std::string_view alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (std::size_t i = 0; i < alphabet.size(); ++i)
        values[static_cast<unsigned char>(alphabet[i])] = static_cast<int>(i);
    return values;
}();

std::vector<std::uint8_t> base64_decoded(std::string_view text, const std::string& where) {
    while (!text.empty() && text.back() == '=') text.remove_suffix(1);
    if (text.size() % 4 == 1) refuse(where, "base64 data", fmt::format("{} characters", text.size()));
    std::vector<std::uint8_t> bytes;
    bytes.reserve(text.size() / 4 * 3 + 2);
    std::uint32_t bits = 0;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const int value = base64_values[static_cast<unsigned char>(text[i])];
        if (value < 0)
            refuse(where, "base64 data", fmt::format("{} at character {}", quote(text.substr(i, 1)), i));
        bits = bits << 6 | static_cast<std::uint32_t>(value);
        if (i % 4 != 0) bytes.push_back(static_cast<std::uint8_t>(bits >> (6 - 2 * (i % 4))));
    }
    return bytes;
}

std::vector<std::uint8_t> data_uri(std::string_view uri, const std::string& where) {
    constexpr std::string_view encoding = ";base64";
    const auto comma = uri.find(',');
    const auto header = uri.substr(0, comma);
    if (comma == uri.npos || header.size() < encoding.size() || !header.ends_with(encoding))
        refuse(where, "data:…;base64,…", quote(header));
    return base64_decoded(uri.substr(comma + 1), where);
}

/// Whether the reference begins like "https:".
bool has_scheme(std::string_view uri) {
    const auto colon = uri.find(':');
    if (colon == uri.npos || colon < 2 || std::isalpha(static_cast<unsigned char>(uri[0])) == 0) return false;
    return std::ranges::all_of(uri.substr(0, colon), [](char c) {
        return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '+' || c == '-' || c == '.';
    });
}

bool leaves_folder(const fs::path& relative) {
    return relative.empty() || relative.is_absolute() || *relative.begin() == "..";
}

/// Whether the real path `target` lies inside one of these folders.
bool lies_in_one_of(const fs::path& target, const std::vector<std::string>& folders) {
    return std::ranges::any_of(folders, [&](const std::string& folder) {
        std::error_code error;
        const fs::path root = fs::canonical(folder, error);
        return !error && !leaves_folder(target.lexically_relative(root));
    });
}

}  // namespace

std::string contained_path(const std::string& name, const std::string& folder, const std::string& where,
                           const std::vector<std::string>& allowed) {
    const std::string expected = allowed.empty() ? "a file inside the scene's folder"
                                                 : "a file inside the scene's folder or an allowed one";
    if (name.empty()) refuse(where, expected, "an empty name");
    const fs::path relative{name};
    const bool leaves = leaves_folder(relative.lexically_normal());
    if (leaves && allowed.empty()) refuse(where, expected, quote(name) + ", which leads outside");
    std::error_code error;
    const fs::path root = fs::canonical(folder, error);
    const fs::path target = error ? fs::path{} : fs::canonical(root / relative, error);
    if (error) refuse(where, "a file that can be read", fmt::format("{}: {}", quote(name), error.message()));
    if (leaves_folder(target.lexically_relative(root)) && !lies_in_one_of(target, allowed))
        refuse(where, expected,
               quote(name) + (leaves ? ", which leads outside" : ", a link that leads outside"));
    return target.string();
}

std::vector<std::uint8_t> read_reference(const std::string& uri, const std::string& folder,
                                         const std::string& where, const std::vector<std::string>& allowed,
                                         std::size_t limit) {
    if (uri.starts_with("data:")) return data_uri(uri, where);
    if (has_scheme(uri)) refuse(where, "a file inside the scene's folder", quote(uri));
    try {
        return read_file(contained_path(percent_decoded(uri, where), folder, where, allowed), limit);
    } catch (const SceneError&) {
        throw;
    } catch (const FileError& error) {
        throw SceneError{fmt::format("{}: {}", where, error.what())};
    }
}

std::string folder_of(const std::string& path) {
    const fs::path folder = fs::path{path}.parent_path();
    return folder.empty() ? "." : folder.string();
}

}  // namespace relumine
