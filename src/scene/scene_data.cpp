// SPDX-License-Identifier: Apache-2.0
// Warnings of a scene, and how names from files are shown in messages.
#include "scene/scene_data.hpp"

#include <algorithm>
#include <utility>

#include "scene/quote.hpp"

namespace relumine {

void SceneData::warn(std::string text) {
    constexpr std::size_t limit = 100;  // a damaged file must not drown its reader
    if (warnings.size() > limit || std::ranges::find(warnings, text) != warnings.end()) return;
    if (warnings.size() == limit) text = "there are more warnings than the 100 that are shown";
    warnings.push_back(std::move(text));
}

std::string quote(std::string_view name) {
    constexpr std::size_t limit = 80;  // bytes
    std::string text = "\"";
    for (const char c : name.substr(0, limit)) {
        const bool control = static_cast<unsigned char>(c) < 0x20 || c == 0x7f;
        text += control ? '?' : c;
    }
    return text + (name.size() > limit ? "…\"" : "\"");
}

}  // namespace relumine
