// SPDX-License-Identifier: Apache-2.0
// Standard streams.
#include "cli/console.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>

#include "relumine/error.hpp"

namespace relumine::cli {
namespace {

int first_output_error = 0;  // errno of the first write to stdout that failed

void note_output_error() {
    if (first_output_error == 0) first_output_error = errno;
    std::clearerr(stdout);
}

}  // namespace

void secure_standard_streams() {
    for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
        if (fcntl(stream, F_GETFD) < 0 && open("/dev/null", O_RDWR) != stream)
            std::abort();  // takes the lowest free
    std::signal(SIGPIPE, SIG_IGN);
    std::signal(SIGXFSZ, SIG_IGN);  // a file size limit is a failed write, not the end
}

void print(std::string_view text) {
    if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size()) note_output_error();
    if (std::fflush(stdout) != 0) note_output_error();
}

void print_line(std::string_view text) {
    const std::string line =
        one_line(text) + "\n";  // one write, so that lines of several processes do not mix
    std::fwrite(line.data(), 1, line.size(), stderr);
}

bool error_is_terminal() { return isatty(STDERR_FILENO) == 1; }

int error_columns() {
    winsize size{};
    const bool known = ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0;
    return known ? size.ws_col : 80;
}

void finish_output() {
    if (first_output_error == 0 || first_output_error == EPIPE) return;
    throw OutputError(fmt::format("standard output: expected to write all of it, found: {}",
                                  std::strerror(first_output_error)));
}

std::string one_line(std::string_view text) {
    std::string line;
    for (const char c : text) {
        const auto code = static_cast<unsigned char>(c);
        if (code < 0x20 || code == 0x7f)
            line += fmt::format("\\x{:02x}", code);
        else
            line += c;
    }
    return line;
}

std::string quote_for_shell(std::string_view argument) {
    const auto plain = [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9')
               || std::string_view("-_./,:=+%@").find(c) != std::string_view::npos;
    };
    if (!argument.empty() && std::ranges::all_of(argument, plain)) return std::string(argument);
    std::string quoted = "'";
    for (const char c : argument) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return quoted + "'";
}

}  // namespace relumine::cli
