// SPDX-License-Identifier: Apache-2.0
// Ctrl-C: the first one asks for the picture so far, the second ends the program.
#pragma once

namespace relumine::cli {

/// From now on the first SIGINT or SIGTERM only sets a flag; the next one of either has its default effect.
void catch_first_interrupt();

/// Whether that first signal has come. Cheap; from any thread.
[[nodiscard]] bool interrupted();

}  // namespace relumine::cli
