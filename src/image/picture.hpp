// SPDX-License-Identifier: Apache-2.0
// An Image of one layer that fills its frame, as most file formats hold it.
#pragma once

#include <string>
#include <vector>

#include "relumine/image.hpp"

namespace relumine {

/// `pixels`: width × height × channels.size(), interleaved, top row first.
[[nodiscard]] Image make_picture(int width, int height, std::vector<std::string> channels,
                                 std::vector<float> pixels);

}  // namespace relumine
