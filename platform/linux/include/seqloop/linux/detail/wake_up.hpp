// SPDX-License-Identifier: MIT
#pragma once

#include "seqloop/clock.hpp"

namespace seqloop::live {

/// Wakes one thread from another, by an eventfd. A call that comes before the wait counts.
class WakeUp {
 public:
  /// Throws SetupError when the system has no file descriptor left.
  WakeUp();
  WakeUp(const WakeUp&) = delete;
  WakeUp& operator=(const WakeUp&) = delete;
  WakeUp(WakeUp&&) = delete;
  WakeUp& operator=(WakeUp&&) = delete;
  ~WakeUp();

  /// Never waits. Work: one system call.
  void call() noexcept;

  /// Returns once called, or after the time-out; earlier where a signal interrupts. May return for
  /// a call whose work was seen before, so look again. Work: two system calls.
  void wait(Nanoseconds timeout) noexcept;

 private:
  int fd_;
};

}  // namespace seqloop::live
