// SPDX-License-Identifier: Apache-2.0
// Runs the built command `relumine` as a user would, and keeps what it said.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace relumine::test {

struct CommandResult {
    int exit_code = 0;  // 128 + signal if it was killed by one
    std::string out, err;
};

struct RunOptions {
    std::string interrupt_when;             // sends SIGINT once stdout holds this text; "": never
    bool insist = false;                    // and SIGTERM right behind it
    int signal = 0;                         // sent instead of SIGINT; 0: SIGINT
    std::optional<int> kill_after;          // milliseconds after which SIGKILL comes
    bool terminal = false;                  // stderr is a terminal of 80 columns
    bool close_stdout = false;              // the command starts without one
    bool break_pipe = false;                // nobody reads stdout
    std::optional<std::size_t> file_limit;  // bytes that a file may have: stands for a full disk
    std::filesystem::path folder;           // to run in; "": the current one
};

[[nodiscard]] CommandResult run_relumine(const std::vector<std::string>& arguments,
                                         const RunOptions& options = {});

[[nodiscard]] std::size_t line_count(const std::string& text);

/// An empty folder of its own, removed at the end.
class ScratchFolder {
  public:
    ScratchFolder();
    ~ScratchFolder();
    ScratchFolder(const ScratchFolder&) = delete;
    ScratchFolder& operator=(const ScratchFolder&) = delete;

    [[nodiscard]] std::string operator/(const std::string& name) const { return (path_ / name).string(); }
    [[nodiscard]] const std::filesystem::path& path() const { return path_; }

  private:
    std::filesystem::path path_;
};

void write_bytes(const std::string& path, const std::string& bytes);
[[nodiscard]] std::string read_bytes(const std::string& path);

/// Whether this machine gives out pseudo-terminals; a bare chroot without /dev/pts does not.
[[nodiscard]] bool terminals_available();

}  // namespace relumine::test
