// SPDX-License-Identifier: Apache-2.0
// How layers, channels and metadata are called in EXR headers.
#pragma once

#include <algorithm>
#include <array>
#include <string>
#include <string_view>

namespace relumine {

/// "albedo.R"; "R" for the picture itself, whose layer has no name.
inline std::string exr_channel_name(const std::string& layer, const std::string& channel) {
    return layer.empty() ? channel : layer + "." + channel;
}

/// Attributes with a meaning of their own, which free text must not take [OpenEXR, "Standard attributes"].
inline bool is_reserved_exr_attribute(std::string_view name) {
    constexpr std::array reserved = {"channels",
                                     "chunkCount",
                                     "compression",
                                     "dataWindow",
                                     "displayWindow",
                                     "lineOrder",
                                     "maxSamplesPerPixel",
                                     "name",
                                     "pixelAspectRatio",
                                     "screenWindowCenter",
                                     "screenWindowWidth",
                                     "tiles",
                                     "type",
                                     "version",
                                     "view"};
    return std::ranges::find(reserved, name) != reserved.end();
}

}  // namespace relumine
