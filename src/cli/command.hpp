// SPDX-License-Identifier: Apache-2.0
// What a command of `relumine` is, and what its exit code means.
#pragma once

#include "cli/arguments.hpp"

namespace relumine::cli {

enum class ExitCode : int {
    done = 0,
    failed = 1,     // bad input or failed output: one line on stderr
    bad_usage = 2,  // arguments or settings that make no sense: one line on stderr
    stopped = 3,    // stopped by a signal, after saving what was there
};

/// Each throws UsageError, relumine::Error or std::bad_alloc; main turns these into a line and an exit code.
ExitCode run_render(const Arguments& arguments);
ExitCode run_info(const Arguments& arguments);
ExitCode run_compare(const Arguments& arguments);
ExitCode run_inspect(const Arguments& arguments);

/// The exit code and the one line that an exception deserves.
[[nodiscard]] ExitCode exit_code_of(const std::exception& error);
[[nodiscard]] std::string line_of(const std::exception& error);

}  // namespace relumine::cli
