// SPDX-License-Identifier: Apache-2.0
// A first look at an EXR header, before OpenEXR sees it and allocates what it asks for.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace relumine {

/// Throws ImageError unless the header is whole, of a kind that we read, and asks for no more memory than an
/// image of allowed size needs and its file can fill.
void check_exr_header(std::span<const std::uint8_t> encoded, const std::string& name);

}  // namespace relumine
