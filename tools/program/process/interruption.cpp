// SPDX-License-Identifier: MIT
#include "program/process/interruption.hpp"

#include <signal.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <stdexcept>

namespace seqloop::program {
namespace {

/// When the program was asked to stop; 0: it was not. Atomic, because the system may give a signal
/// to any thread: a library's workers run too.
std::atomic<std::int64_t> asked_ns = 0;
static_assert(std::atomic<std::int64_t>::is_always_lock_free, "a signal handler may write it");

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

void ask(int signal) {
  // By clock_gettime, which a signal handler may call.
  const std::chrono::nanoseconds now = std::chrono::steady_clock::now().time_since_epoch();
  std::int64_t first = 0;
  if (asked_ns.compare_exchange_strong(first, now.count())) return;
  if (now - std::chrono::nanoseconds(first) < std::chrono::seconds(1)) return;
  handle_with(SIG_DFL);
  raise(signal);  // taken when this has returned
}

}  // namespace

void take_interruptions() noexcept { handle_with(ask); }

bool interrupted() noexcept { return asked_ns != 0; }

void stop_if_interrupted() {
  if (interrupted()) throw std::runtime_error("interrupted: nothing has been written");
}

}  // namespace seqloop::program
