// SPDX-License-Identifier: Apache-2.0
// Signals; the handler uses nothing but what POSIX allows in one.
#include "cli/interrupt.hpp"

#include <signal.h>

#include <atomic>

namespace relumine::cli {
namespace {

std::atomic<bool> interrupt_came{false};
static_assert(std::atomic<bool>::is_always_lock_free);

void set_action(void (*handler)(int)) {
    struct sigaction action {};
    action.sa_handler = handler;
    action.sa_flags = SA_RESTART;
    sigemptyset(&action.sa_mask);
    sigaction(SIGINT, &action, nullptr);
    sigaction(SIGTERM, &action, nullptr);
}

/// Two threads may be here at once; whichever comes second ends the program.
extern "C" void note_interrupt(int signal) {
    if (!interrupt_came.exchange(true)) return;
    set_action(SIG_DFL);
    raise(signal);
}

}  // namespace

void catch_first_interrupt() { set_action(note_interrupt); }

bool interrupted() { return interrupt_came.load(std::memory_order_relaxed); }

}  // namespace relumine::cli
