// SPDX-License-Identifier: Apache-2.0
// Whole files in and out: bounded reads, atomic writes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace relumine {

inline constexpr std::size_t default_file_limit = std::size_t{8} << 30;  // bytes

/// The whole file. Throws FileError when it cannot be opened or read, is a folder, or is larger than `limit`
/// bytes.
[[nodiscard]] std::vector<std::uint8_t> read_file(const std::string& path,
                                                  std::size_t limit = default_file_limit);

/// Whether these bytes begin a gzip stream.
[[nodiscard]] bool is_gzip(std::span<const std::uint8_t> bytes);

/// The unpacked gzip stream. Throws FileError (naming `path`) when it is damaged or unpacks to more than
/// `limit` bytes.
[[nodiscard]] std::vector<std::uint8_t> unpack_gzip(std::span<const std::uint8_t> packed,
                                                    const std::string& path,
                                                    std::size_t limit = default_file_limit);

/// Writes beside `path` and renames, so that `path` holds the old bytes or all of the new ones, never half a
/// file. Throws OutputError and leaves nothing behind. `unfinished`: what the file is called until it is
/// whole;
/// "": a name that no other process uses, which a killed one leaves behind.
void write_file_atomically(const std::string& path, std::span<const std::uint8_t> bytes,
                           const std::string& unfinished = "");

}  // namespace relumine
