// SPDX-License-Identifier: Apache-2.0
// What goes to the terminal, and what must not go wrong on the way there.
#pragma once

#include <string>
#include <string_view>

namespace relumine::cli {

/// Call first in main: opens standard streams that are closed (else a picture's file could become "stdout"),
/// and lets a reader that went away, or a file size limit, cost that output alone instead of ending the
/// program.
void secure_standard_streams();

void print(std::string_view text);       // to stdout
void print_line(std::string_view text);  // to stderr, always exactly one line
[[nodiscard]] bool error_is_terminal();  // whether a person may be watching stderr
[[nodiscard]] int error_columns();       // width of that terminal

/// Throws OutputError if something printed to stdout was lost, unless its reader closed it.
void finish_output();

/// The text with control characters made visible, so that it takes one line.
[[nodiscard]] std::string one_line(std::string_view text);

/// The command as a shell would take it again: arguments quoted where needed, separated by blanks.
[[nodiscard]] std::string quote_for_shell(std::string_view argument);

}  // namespace relumine::cli
