// SPDX-License-Identifier: Apache-2.0
// Files that a command will write: checked before hours of work, written whole or not at all.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace relumine::cli {

/// Whether the file's extension (in any case) is one of these, e.g. {".exr", ".png"}.
[[nodiscard]] bool has_extension(const std::string& path, std::span<const std::string_view> extensions);

/// Throws OutputError unless a file may be created beside `path` and renamed to it. Devices and pipes pass.
void check_writable(const std::string& path);

/// Throws UsageError for an extension that pictures do not have or a name given twice, else as
/// check_writable.
void check_pictures(std::string_view option, const std::vector<std::string>& paths);

/// Writes beside `path` and renames (devices and pipes: writes directly; "-": prints). Throws OutputError.
void write_text(const std::string& path, const std::string& text);

}  // namespace relumine::cli
