// SPDX-License-Identifier: Apache-2.0
// The files that a pbrt scene refers to.
#include "scene/pbrt_files.hpp"

#include <fmt/format.h>

#include <filesystem>

#include "base/file.hpp"
#include "relumine/error.hpp"
#include "scene/quote.hpp"
#include "scene/reference.hpp"

namespace relumine {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t max_files = 100'000;
constexpr std::size_t max_bytes_in_all = std::size_t{16} << 30;

}  // namespace

PbrtFiles::PbrtFiles(const std::string& scene_path)
    : folder_(folder_of(scene_path)), bytes_left_(max_bytes_in_all) {}

std::string PbrtFiles::resolve(const std::string& name, const PbrtPlace& place) const {
    std::error_code error;
    fs::path relative{name};
    if (relative.is_relative() && place.file && !fs::exists(fs::path{folder_} / relative, error)) {
        const fs::path beside = fs::path{folder_of(*place.file)} / relative;
        const fs::path root = fs::canonical(folder_, error);
        const fs::path real = fs::canonical(beside, error);
        if (!error) relative = real.lexically_relative(root);
    }
    return contained_path(relative.string(), folder_, place.text());
}

std::vector<std::uint8_t> PbrtFiles::read(const std::string& name, const PbrtPlace& place) {
    if (++files_ > max_files) refuse_pbrt(place, fmt::format("at most {} files", max_files), "more");
    try {
        const std::string path = resolve(name, place);
        std::vector<std::uint8_t> bytes = read_file(path, bytes_left_);
        if (is_gzip(bytes)) bytes = unpack_gzip(bytes, path, bytes_left_);
        bytes_left_ -= bytes.size();
        return bytes;
    } catch (const SceneError&) {
        throw;
    } catch (const FileError& error) {
        throw SceneError{fmt::format("{}: {}", place.text(), error.what())};
    }
}

}  // namespace relumine
