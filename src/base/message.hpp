// SPDX-License-Identifier: Apache-2.0
// The wording of messages: where, expected, found; and the nearest name to a misspelt one.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace relumine {

/// "where: expected E, found F".
std::string expected_found(std::string_view where, std::string_view expected, std::string_view found);

/// " (did you mean \"cornell\"?)", or "" where no candidate is near.
std::string did_you_mean(std::string_view name, std::span<const std::string> candidates);

/// "a", "a or b", "a, b or c".
std::string one_of(std::span<const std::string> names);

}  // namespace relumine
