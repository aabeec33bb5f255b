// SPDX-License-Identifier: Apache-2.0
// The wording of messages.
#include "base/message.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <vector>

namespace relumine {
namespace {

/// Number of single-character edits between two words.
std::size_t edit_distance(std::string_view a, std::string_view b) {
    std::vector<std::size_t> row(b.size() + 1);
    std::iota(row.begin(), row.end(), std::size_t{0});
    for (std::size_t i = 1; i <= a.size(); ++i) {
        std::size_t diagonal = row[0];
        row[0] = i;
        for (std::size_t j = 1; j <= b.size(); ++j) {
            const std::size_t substitute = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
            diagonal = row[j];
            row[j] = std::min({row[j] + 1, row[j - 1] + 1, substitute});
        }
    }
    return row.back();
}

}  // namespace

std::string expected_found(std::string_view where, std::string_view expected, std::string_view found) {
    return fmt::format("{}: expected {}, found {}", where, expected, found);
}

std::string did_you_mean(std::string_view name, std::span<const std::string> candidates) {
    const auto distance = [&](const std::string& candidate) { return edit_distance(name, candidate); };
    const auto nearest = std::ranges::min_element(candidates, {}, distance);
    if (nearest == candidates.end() || distance(*nearest) > std::max<std::size_t>(1, name.size() / 3))
        return "";
    return fmt::format(" (did you mean \"{}\"?)", *nearest);
}

std::string one_of(std::span<const std::string> names) {
    std::string text;
    for (std::size_t i = 0; i < names.size(); ++i) {
        if (i > 0) text += i + 1 == names.size() ? " or " : ", ";
        text += names[i];
    }
    return text;
}

}  // namespace relumine
