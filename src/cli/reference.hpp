// SPDX-License-Identifier: Apache-2.0
// The picture that a render is measured against.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "relumine/compare.hpp"
#include "relumine/render.hpp"

namespace relumine::cli {

/// Of the full frame's size, it is cut to the window; of the window's, it is taken as it is. Throws
/// ImageError for another size: before hours of work, not after them.
[[nodiscard]] Image read_reference(const std::string& path, const PictureFrame& frame);

[[nodiscard]] nlohmann::ordered_json reference_json(const std::string& path, const Comparison& comparison);
[[nodiscard]] nlohmann::ordered_json coverage_json(const ErrorCoverage& coverage);

}  // namespace relumine::cli
