// SPDX-License-Identifier: Apache-2.0
// How names that come from files are shown in messages.
#pragma once

#include <string>
#include <string_view>

namespace relumine {

/// The name in quotation marks on one line: control characters become '?', long names are cut.
[[nodiscard]] std::string quote(std::string_view name);

}  // namespace relumine
