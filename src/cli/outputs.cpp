// SPDX-License-Identifier: Apache-2.0
// Files that a command will write.
#include "cli/outputs.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>

#include "cli/arguments.hpp"
#include "cli/console.hpp"
#include "relumine/error.hpp"

namespace relumine::cli {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::string_view, 3> picture_extensions{".exr", ".png", ".pfm"};

std::string folder_of(const std::string& path) {
    const std::string parent = fs::path(path).parent_path().string();
    return parent.empty() ? "." : parent;
}

/// A name beside `path` that no one else uses.
std::string temporary_name(const std::string& path) {
    return fmt::format("{}.{}.relumine-tmp", path, getpid());
}

bool is_stream(const std::string& path) {
    std::error_code error;
    const fs::file_status status = fs::status(path, error);
    return fs::is_character_file(status) || fs::is_fifo(status) || fs::is_socket(status);
}

OutputError cannot_write(const std::string& path, std::string_view expected, int error) {
    return OutputError(fmt::format("{}: expected {}, found: {}", path, expected, std::strerror(error)));
}

/// Creates an empty file and removes it: the only test that holds on every file system and for every user.
void try_to_create(const std::string& path) {
    const std::string probe = temporary_name(path);
    const int file = open(probe.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
    if (file < 0)
        throw cannot_write(path, fmt::format("to be able to write in \"{}\"", folder_of(path)), errno);
    close(file);
    unlink(probe.c_str());
}

void write_directly(const std::string& path, const std::string& text) {
    std::FILE* file = std::fopen(path.c_str(), "wb");
    if (!file) throw cannot_write(path, "to be able to write it", errno);
    const bool written =
        std::fwrite(text.data(), 1, text.size(), file) == text.size() && std::fflush(file) == 0;
    const int error = errno;
    if (std::fclose(file) != 0 || !written)
        throw cannot_write(path, "to write all of it", written ? errno : error);
}

}  // namespace

bool has_extension(const std::string& path, std::span<const std::string_view> extensions) {
    std::string extension = fs::path(path).extension().string();
    std::ranges::transform(extension, extension.begin(), [](unsigned char c) { return std::tolower(c); });
    return std::ranges::find(extensions, extension) != extensions.end();
}

void check_writable(const std::string& path) {
    if (is_stream(path)) return;
    std::error_code error;
    if (fs::is_directory(path, error))
        throw OutputError(fmt::format("{}: expected the name of a file, found a folder", path));
    if (!fs::is_directory(folder_of(path), error))
        throw OutputError(
            fmt::format("{}: expected an existing folder \"{}\", found none", path, folder_of(path)));
    try_to_create(path);
}

void check_pictures(std::string_view option, const std::vector<std::string>& paths) {
    for (auto path = paths.begin(); path != paths.end(); ++path) {
        if (!has_extension(*path, picture_extensions))
            throw unexpected_value(option, "a file name that ends in .exr, .png or .pfm", *path);
        if (std::find(paths.begin(), path, *path) != path)
            throw UsageError(fmt::format("{}: expected each file once, found \"{}\" twice", option, *path));
        check_writable(*path);
    }
}

void write_text(const std::string& path, const std::string& text) {
    if (path == "-") return print(text);
    if (is_stream(path)) return write_directly(path, text);
    const std::string temporary = temporary_name(path);
    try {
        write_directly(temporary, text);
        if (std::rename(temporary.c_str(), path.c_str()) != 0)
            throw cannot_write(path, "to be able to replace it", errno);
    } catch (...) {
        unlink(temporary.c_str());
        throw;
    }
}

}  // namespace relumine::cli
