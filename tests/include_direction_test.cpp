// SPDX-License-Identifier: Apache-2.0
// Which folder may include which (docs/architecture.md): along the data's way through the program, never
// against it.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

namespace {

/// The folders of src/, each below those it may include.
constexpr std::array<std::string_view, 12> folder_order{"base",    "image",       "scene", "trace",
                                                        "shading", "radiance",    "cache", "blocks",
                                                        "rivals",  "integrators", "film",  "cli"};
/// Folders that may include less than everything above them; itself goes without saying.
const std::map<std::string_view, std::vector<std::string_view>> narrower{
    {"film", {"base", "image"}},  // knows tiles, not integrators
    {"cli", {}},                  // proves that the public headers are enough
};

struct Include {
    int line;
    std::string path;
    bool quoted;  // "path", otherwise <path>
};

/// `text` behind leading blanks and `prefix`; empty where it does not begin so.
std::string_view behind(std::string_view prefix, std::string_view text) {
    text.remove_prefix(std::min(text.find_first_not_of(" \t"), text.size()));
    return text.starts_with(prefix) ? text.substr(prefix.size()) : std::string_view{};
}

/// The path between `open` and `close` at the beginning of `text`, blanks aside.
std::optional<std::string> enclosed(std::string_view text, std::string_view open, char close) {
    const std::string_view rest = behind(open, text);
    const std::size_t end = rest.find(close);
    if (end == std::string_view::npos) return std::nullopt;
    return std::string(rest.substr(0, end));
}

std::vector<Include> includes_of(std::string_view text) {
    std::vector<Include> found;
    std::istringstream lines{std::string(text)};
    std::string line;
    for (int number = 1; std::getline(lines, line); ++number) {
        const std::string_view target = behind("include", behind("#", line));
        if (const auto path = enclosed(target, "\"", '"')) found.push_back({number, *path, true});
        if (const auto path = enclosed(target, "<", '>')) found.push_back({number, *path, false});
    }
    return found;
}

/// "a" of "a/b"; empty where there is no folder.
std::string_view first_part(std::string_view path) {
    const std::size_t slash = path.find('/');
    return slash == std::string_view::npos ? std::string_view{} : path.substr(0, slash);
}

/// Position in folder_order, or its size for a name that is not there.
std::size_t rank(std::string_view folder) {
    return static_cast<std::size_t>(std::ranges::find(folder_order, folder) - folder_order.begin());
}

bool folder_may_include(std::string_view folder, std::string_view other) {
    if (folder == other) return true;
    if (const auto limited = narrower.find(folder); limited != narrower.end())
        return std::ranges::find(limited->second, other) != limited->second.end();
    return rank(other) < rank(folder);
}

/// Why a public header must not include this, or nothing.
std::optional<std::string> objection_to_public(const Include& include) {
    const bool standard =
        include.path.find_first_not_of("abcdefghijklmnopqrstuvwxyz_") == std::string::npos;  // <vector>
    const bool fine = include.quoted ? first_part(include.path) == "relumine" : standard;
    if (fine) return std::nullopt;
    return "a public header may include the standard library and \"relumine/…\" alone";
}

/// Why a file of src/ must not include this, or nothing. `folder` is empty for files directly in src/, which
/// tie the ends together.
std::optional<std::string> objection_to_internal(std::string_view folder, bool is_test,
                                                 const Include& include) {
    const std::string_view other = first_part(include.path);
    if (other == "relumine" && include.quoted) return std::nullopt;
    if (!include.quoted) {
        if (rank(other) < folder_order.size() || other == "relumine")
            return "the project's own headers go in quotes";
        return std::nullopt;
    }
    if (is_test && other == "tests") return std::nullopt;      // helpers that tests share
    if (folder.empty() && other.empty()) return std::nullopt;  // what those that tie the ends share
    if (rank(other) == folder_order.size()) return "expected a path from src/, such as \"base/vec.hpp\"";
    const bool fine = folder.empty() ? other != "cli" : folder_may_include(folder, other);
    if (fine) return std::nullopt;
    return fmt::format("{} must not include {}", folder.empty() ? "src" : folder, other);
}

/// One line per include that `path` (from the project's root, in src/ or include/) must not have.
std::vector<std::string> wrong_includes(std::string_view path, std::string_view text) {
    const bool is_public = path.starts_with("include/");
    const bool is_test = path.ends_with("_test.cpp");
    const std::string_view folder = is_public ? "" : first_part(path.substr(path.find('/') + 1));
    std::vector<std::string> wrong;
    if (!is_public && !folder.empty() && rank(folder) == folder_order.size())
        wrong.push_back(fmt::format("{}: src/{} has no place in the order of folders", path, folder));
    for (const Include& include : includes_of(text)) {
        const auto objection =
            is_public ? objection_to_public(include) : objection_to_internal(folder, is_test, include);
        if (objection)
            wrong.push_back(fmt::format("{}:{}: {}: {}", path, include.line, include.path, *objection));
    }
    return wrong;
}

std::string read_text(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

/// Every C++ file in src/ and include/, from the project's root, with its text.
std::map<std::string, std::string> project_files() {
    const std::filesystem::path root = RELUMINE_SOURCE_DIR;
    std::map<std::string, std::string> files;
    for (const char* top : {"src", "include"})
        for (const auto& entry : std::filesystem::recursive_directory_iterator(root / top))
            if (const auto extension = entry.path().extension(); extension == ".cpp" || extension == ".hpp")
                files[entry.path().lexically_relative(root).generic_string()] = read_text(entry.path());
    return files;
}

}  // namespace

TEST(IncludeDirection, NoFileOfTheProjectIncludesAgainstTheOrder) {
    const auto files = project_files();
    EXPECT_TRUE(files.contains("src/base/vec.hpp") && files.contains("include/relumine/scene.hpp"));
    std::size_t includes = 0;
    for (const auto& [path, text] : files) {
        includes += includes_of(text).size();
        for (const std::string& wrong : wrong_includes(path, text)) ADD_FAILURE() << wrong;
    }
    EXPECT_GT(includes, 2 * files.size()) << "the reader of #include lines sees too few of them";
}

TEST(IncludeDirection, EveryPlantedViolationIsFound) {
    struct Planted {
        const char* path;
        const char* line;
    };
    constexpr Planted planted[]{
        {"src/base/vec.hpp", "#include \"image/byte_image.hpp\""},           // below
        {"src/image/png.cpp", "#include \"scene/scene_data.hpp\""},          // below
        {"src/scene/gltf.cpp", "#include \"trace/tracer.hpp\""},             // below
        {"src/trace/tracer.hpp", "  #  include \"shading/bsdf.hpp\""},       // below, with blanks
        {"src/shading/bsdf_test.cpp", "#include \"integrators/path.hpp\""},  // tests have no privilege
        {"src/cache/record.hpp", "#include \"film/film.hpp\""},              // below
        {"src/integrators/path.cpp", "#include \"film/film.hpp\""},          // below
        {"src/film/film.cpp", "#include \"scene/scene_data.hpp\""},          // above, but film is limited
        {"src/film/film.cpp", "#include \"integrators/registry.hpp\""},      // above, but film is limited
        {"src/cli/render.cpp", "#include \"base/file.hpp\""},                // above, but cli is limited
        {"src/render.cpp", "#include \"cli/arguments.hpp\""},                // the library knows no command
        {"src/base/vec.hpp", "#include \"frame.hpp\""},                      // not from src/
        {"src/base/vec.hpp", "#include \"../scene/scene_data.hpp\""},        // not from src/
        {"src/base/vec.hpp", "#include <scene/scene_data.hpp>"},             // hidden in angle brackets
        {"src/base/vec.hpp", "#include \"tests/chi_square.hpp\""},           // tests' helpers are for tests
        {"src/utils/misc.hpp", "#include <vector>"},                         // a folder outside the order
        {"include/relumine/scene.hpp", "#include <embree3/rtcore.h>"},       // third party
        {"include/relumine/scene.hpp", "#include <png.h>"},                  // third party
        {"include/relumine/scene.hpp", "#include \"base/vec.hpp\""},         // internal
    };
    for (const Planted& p : planted)
        EXPECT_EQ(wrong_includes(p.path, std::string("#pragma once\n") + p.line + "\n").size(), 1u)
            << p.path << ": " << p.line;
}

TEST(IncludeDirection, WhatTheOrderAllowsPasses) {
    EXPECT_EQ(wrong_includes("src/scene/gltf.cpp",
                             "#include \"scene/readers.hpp\"\n\n#include <tiny_gltf.h>\n"
                             "#include \"base/file.hpp\"\n#include \"image/byte_image.hpp\"\n"
                             "#include \"relumine/error.hpp\"\n// #include \"cli/arguments.hpp\"\n"),
              std::vector<std::string>{});
    EXPECT_EQ(wrong_includes("src/film/film_test.cpp",
                             "#include <gtest/gtest.h>\n#include \"film/film.hpp\"\n"
                             "#include \"image/exr.hpp\"\n#include \"tests/images.hpp\"\n"),
              std::vector<std::string>{});
    EXPECT_EQ(
        wrong_includes(
            "src/cli/main.cpp",
            "#include <CLI/CLI.hpp>\n#include \"relumine/render.hpp\"\n#include \"cli/arguments.hpp\"\n"),
        std::vector<std::string>{});
    EXPECT_EQ(wrong_includes("src/render.cpp",
                             "#include \"film/film.hpp\"\n#include \"integrators/registry.hpp\"\n"
                             "#include \"render_setup.hpp\"\n"),
              std::vector<std::string>{});
    EXPECT_EQ(wrong_includes("include/relumine/render.hpp",
                             "#include <cstdint>\n#include \"relumine/scene.hpp\"\n"),
              std::vector<std::string>{});
}

TEST(IncludeDirection, AMessageSaysWhere) {
    EXPECT_EQ(wrong_includes("src/base/vec.hpp", "#pragma once\n\n#include \"film/film.hpp\"\n"),
              std::vector<std::string>{"src/base/vec.hpp:3: film/film.hpp: base must not include film"});
}
