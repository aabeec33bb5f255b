// SPDX-License-Identifier: Apache-2.0
// The files that one scene refers to.
#include "scene/scene_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "base/file.hpp"
#include "base/message.hpp"
#include "relumine/error.hpp"
#include "scene/reference.hpp"

namespace relumine {
namespace {

namespace fs = std::filesystem;

}  // namespace

SceneFiles::SceneFiles(const std::string& scene_path, std::vector<std::string> allowed_folders)
    : folder_(folder_of(scene_path)), allowed_folders_(std::move(allowed_folders)) {}

std::string SceneFiles::resolve(const std::string& name, const std::string& where,
                                const std::string& named_in) const {
    std::error_code error;
    fs::path relative{name};
    if (relative.is_relative() && !named_in.empty() && !fs::exists(fs::path{folder_} / relative, error)) {
        const fs::path root = fs::canonical(folder_, error);
        const fs::path real = fs::canonical(fs::path{folder_of(named_in)} / relative, error);
        if (!error) relative = real.lexically_relative(root);
    }
    return contained_path(relative.string(), folder_, where, allowed_folders_);
}

std::vector<std::uint8_t> SceneFiles::read(const std::string& name, const std::string& where,
                                           const std::string& named_in) {
    count_file(where);
    try {
        const std::string path = resolve(name, where, named_in);
        std::vector<std::uint8_t> bytes = read_file(path, bytes_left());
        if (is_gzip(bytes)) bytes = unpack_gzip(bytes, path, bytes_left());
        count_bytes(bytes.size(), where);
        return bytes;
    } catch (const SceneError&) {
        throw;
    } catch (const FileError& error) {
        throw SceneError{fmt::format("{}: {}", where, error.what())};
    }
}

std::vector<std::uint8_t> SceneFiles::read_uri(const std::string& uri, const std::string& where) {
    count_file(where);
    std::vector<std::uint8_t> bytes = read_reference(uri, folder_, where, allowed_folders_, bytes_left());
    count_bytes(bytes.size(), where);
    return bytes;
}

void SceneFiles::count_file(const std::string& where) {
    if (++files_ > max_scene_files)
        throw SceneError{expected_found(where, fmt::format("at most {} files", max_scene_files), "more")};
}

void SceneFiles::count_bytes(std::size_t bytes, const std::string& where) {
    if ((bytes_ += bytes) > max_scene_file_bytes)
        throw SceneError{
            expected_found(where, fmt::format("at most {} bytes of files", max_scene_file_bytes), "more")};
}

std::size_t SceneFiles::bytes_left() const {
    return max_scene_file_bytes - std::min<std::size_t>(bytes_, max_scene_file_bytes);
}

}  // namespace relumine
