// SPDX-License-Identifier: Apache-2.0
// What is fuzzed: every reader of bytes that somebody else wrote, each as a function of bytes. A reader may
// refuse (throw relumine::Error); anything else that goes wrong is a finding.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace relumine::fuzz {

using Bytes = std::span<const std::uint8_t>;

struct Target {
    std::string_view name;  // also of the folders of its seeds and regressions
    void (*run)(Bytes);
};

/// gltf, pbrt, mitsuba, ply, obj: scenes; picture: EXR, HDR, PFM, PNG, JPEG as pictures; texture: PNG, JPEG
/// as textures; checkpoint.
[[nodiscard]] const std::vector<Target>& targets();

}  // namespace relumine::fuzz
