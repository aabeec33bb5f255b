// SPDX-License-Identifier: Apache-2.0
// Runs the built command.
#include "run_command.hpp"

#include <fcntl.h>
#include <poll.h>
#include <pty.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <fstream>
#include <sstream>
#include <stdexcept>

namespace relumine::test {
namespace {

struct Channel {
    int read = -1, write = -1;  // file descriptors; −1: closed
};

void close_end(int& end) {
    if (end >= 0) close(end);
    end = -1;
}

Channel make_pipe() {
    std::array<int, 2> ends{};
    if (pipe2(ends.data(), O_CLOEXEC) != 0) throw std::runtime_error("pipe");
    return {ends[0], ends[1]};
}

Channel make_terminal() {
    Channel terminal;
    const winsize size{24, 80, 0, 0};
    if (openpty(&terminal.read, &terminal.write, nullptr, nullptr, &size) != 0)
        throw std::runtime_error("openpty");
    return terminal;
}

void limit_files(std::size_t bytes) {
    const rlimit limit{bytes, bytes};
    setrlimit(RLIMIT_FSIZE, &limit);
}

constexpr unsigned deadline = 120;  // seconds, after which a command that hangs is killed

/// In the child, between fork and exec: system calls alone.
[[noreturn]] void become_command(std::vector<char*>& argv, const RunOptions& options, int out, int err) {
    dup2(open("/dev/null", O_RDONLY), STDIN_FILENO);
    dup2(err, STDERR_FILENO);
    dup2(out, STDOUT_FILENO);
    if (options.close_stdout) close(STDOUT_FILENO);
    if (options.file_limit) limit_files(*options.file_limit);
    if (!options.folder.empty() && chdir(options.folder.c_str()) != 0) _exit(126);
    std::signal(SIGINT, SIG_DFL);  // a test runner in the background ignores it
    alarm(deadline);               // survives exec
    execv(RELUMINE_COMMAND, argv.data());
    _exit(127);
}

pid_t start(const std::vector<std::string>& arguments, const RunOptions& options, int out, int err) {
    std::vector<std::string> words{"relumine"};
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    const pid_t child = fork();
    if (child < 0) throw std::runtime_error("fork");
    if (child == 0) become_command(argv, options, out, err);
    return child;
}

/// Appends what is there; closes the channel at its end.
void receive(int& from, std::string& to) {
    std::array<char, 4096> buffer{};
    const ssize_t count = read(from, buffer.data(), buffer.size());
    if (count > 0)
        to.append(buffer.data(), static_cast<std::size_t>(count));
    else
        close_end(from);
}

using Clock = std::chrono::steady_clock;

/// Sends SIGKILL when its time has come, once.
class Killer {
  public:
    Killer(pid_t child, std::optional<int> after) : child_(child), waits_(after.has_value()) {
        if (after) when_ += std::chrono::milliseconds(*after);
    }
    /// How long to wait before looking again, milliseconds.
    [[nodiscard]] int pause() {
        constexpr int usual = 10;
        if (!waits_) return usual;
        const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(when_ - Clock::now()).count();
        if (left > 0) return static_cast<int>(std::min<long long>(left, usual));
        kill(child_, SIGKILL);
        waits_ = false;
        return usual;
    }

  private:
    pid_t child_;
    bool waits_;
    Clock::time_point when_ = Clock::now();
};

/// Reads both streams to their ends and interrupts when the time has come.
void listen(pid_t child, const RunOptions& options, int& out, int& err, CommandResult& result) {
    bool to_interrupt = !options.interrupt_when.empty();
    Killer killer(child, options.kill_after);
    while (out >= 0 || err >= 0) {
        std::array<pollfd, 2> streams{{{out, POLLIN, 0}, {err, POLLIN, 0}}};  // poll skips −1
        if (poll(streams.data(), streams.size(), killer.pause()) < 0) throw std::runtime_error("poll");
        if (streams[0].revents != 0) receive(out, result.out);
        if (streams[1].revents != 0) receive(err, result.err);
        if (to_interrupt && result.out.find(options.interrupt_when) != std::string::npos) {
            to_interrupt = false;
            kill(child, options.signal == 0 ? SIGINT : options.signal);
            if (options.insist) kill(child, SIGTERM);
        }
    }
}

int exit_code_of(pid_t child) {
    int status = 0;
    waitpid(child, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

}  // namespace

bool terminals_available() {
    int controller = -1, terminal = -1;
    if (openpty(&controller, &terminal, nullptr, nullptr, nullptr) != 0) return false;
    close(controller);
    close(terminal);
    return true;
}

CommandResult run_relumine(const std::vector<std::string>& arguments, const RunOptions& options) {
    Channel out = make_pipe();
    Channel err = options.terminal ? make_terminal() : make_pipe();
    const pid_t child = start(arguments, options, out.write, err.write);
    close_end(out.write);
    close_end(err.write);
    if (options.break_pipe) close_end(out.read);
    CommandResult result;
    listen(child, options, out.read, err.read, result);
    result.exit_code = exit_code_of(child);
    return result;
}

std::size_t line_count(const std::string& text) {
    return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

ScratchFolder::ScratchFolder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "relumine-test-XXXXXX").string();
    if (!mkdtemp(pattern.data())) throw std::runtime_error("mkdtemp");
    path_ = pattern;
}

ScratchFolder::~ScratchFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
}

void write_bytes(const std::string& path, const std::string& bytes) {
    std::ofstream(path, std::ios::binary) << bytes;
}

std::string read_bytes(const std::string& path) {
    std::ostringstream bytes;
    bytes << std::ifstream(path, std::ios::binary).rdbuf();
    return bytes.str();
}

}  // namespace relumine::test
