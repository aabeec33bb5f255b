// SPDX-License-Identifier: Apache-2.0
// Which of the machine's vector instructions are used.
#pragma once

#include <string>

namespace relumine {

/// What choose_instruction_set() of the public API was given, or "".
[[nodiscard]] std::string chosen_instruction_set();

/// The one in use, as the kernels call it, such as "AVX2".
[[nodiscard]] std::string current_instruction_set();

}  // namespace relumine
