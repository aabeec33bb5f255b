// SPDX-License-Identifier: Apache-2.0
// What every decoder refuses, and in which words.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace relumine {

/// Throws ImageError "name: expected …, found …" on one line, whatever a library put into `found`.
[[noreturn]] void fail_image(const std::string& name, std::string_view expected, std::string_view found);

/// Throws ImageError unless 1 ≤ width, height ≤ max_image_side and width × height ≤ max_image_pixels.
void check_image_size(std::int64_t width, std::int64_t height, const std::string& name);

/// Throws ImageError when a file of `size` bytes cannot hold `samples_bytes` bytes of pixels: deflate, the
/// densest of the codings that use this check, packs at most 1032 bytes into one. (JPEG: 512 of one channel.)
void check_packed_size(std::uint64_t samples_bytes, std::size_t size, const std::string& name);

/// Whether the bytes begin with `magic`.
[[nodiscard]] bool starts_with(std::span<const std::uint8_t> bytes, std::string_view magic);

}  // namespace relumine
