// SPDX-License-Identifier: Apache-2.0
// The files that one scene refers to: where they may lie, how many there may be, and how large.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace relumine {

/// Limits on what one scene may refer to, the same for every format. Counted as often as they are named.
inline constexpr std::size_t max_scene_files = 100'000;
inline constexpr std::size_t max_scene_file_bytes = std::size_t{16} << 30;  // in all, unpacked
inline constexpr std::size_t max_include_depth = 32;  // files inside each other, the scene itself included

/// Reads what a scene refers to by name or URI: files in its folder or in a folder that the user allows.
/// Calls may come from several threads. Everything throws SceneError; `where` begins the message.
class SceneFiles {
  public:
    explicit SceneFiles(const std::string& scene_path, std::vector<std::string> allowed_folders = {});

    /// The scene's own folder.
    [[nodiscard]] const std::string& folder() const { return folder_; }

    /// The real path of the file `name`, relative to the scene's folder or else to that of the file
    /// `named_in`; "": the scene's alone.
    [[nodiscard]] std::string resolve(const std::string& name, const std::string& where,
                                      const std::string& named_in = "") const;
    /// The file's bytes, unpacked where it is packed with gzip.
    [[nodiscard]] std::vector<std::uint8_t> read(const std::string& name, const std::string& where,
                                                 const std::string& named_in = "");
    /// The bytes behind a URI: of a file, or those inside the URI.
    [[nodiscard]] std::vector<std::uint8_t> read_uri(const std::string& uri, const std::string& where);

  private:
    void count_file(const std::string& where);
    void count_bytes(std::size_t bytes, const std::string& where);
    [[nodiscard]] std::size_t bytes_left() const;

    std::string folder_;
    std::vector<std::string> allowed_folders_;
    std::atomic<std::size_t> files_ = 0, bytes_ = 0;
};

}  // namespace relumine
