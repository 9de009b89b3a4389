// SPDX-License-Identifier: MIT
#include "program/process/interruption.hpp"

#include <signal.h>

#include <atomic>
#include <stdexcept>

namespace seqloop::program {
namespace {

/// Atomic, because the system may give a signal to any thread: a library's workers run too.
std::atomic<bool> asked = false;
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler may write it");

/// Gives the signals to a handler, but for those that are ignored.
void handle_with(void (*handler)(int)) noexcept {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction action {};
    sigaction(signal, nullptr, &action);
    if (action.sa_handler == SIG_IGN) continue;  // nohup and the shell's & want it so
    action = {};
    action.sa_handler = handler;
    sigaction(signal, &action, nullptr);
  }
}

void ask(int /*signal*/) {
  asked = true;
  handle_with(SIG_DFL);  // the next one ends the program, whichever it is
}

}  // namespace

void take_interruptions() noexcept { handle_with(ask); }

bool interrupted() noexcept { return asked; }

void stop_if_interrupted() {
  if (interrupted()) throw std::runtime_error("interrupted: nothing has been written");
}

}  // namespace seqloop::program
