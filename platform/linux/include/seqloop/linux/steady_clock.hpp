// SPDX-License-Identifier: MIT
#pragma once

#include <time.h>

#include <cerrno>

#include "seqloop/clock.hpp"

namespace seqloop::live {

/// CLOCK_MONOTONIC, which V4L2 stamps frames with. Any number of threads may ask it.
class SteadyClock : public Clock {
 public:
  [[nodiscard]] Nanoseconds now() noexcept override {
    timespec time{};
    clock_gettime(CLOCK_MONOTONIC, &time);
    return std::chrono::seconds(time.tv_sec) + Nanoseconds(time.tv_nsec);
  }

  /// Nothing wakes it earlier: who must heed a stop sleeps in time steps.
  void sleep_until(Nanoseconds moment) noexcept override {
    const auto seconds = std::chrono::floor<std::chrono::seconds>(moment);
    timespec time{};
    time.tv_sec = static_cast<time_t>(seconds.count());
    time.tv_nsec = static_cast<long>((moment - seconds).count());
    while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &time, nullptr) == EINTR) {
    }
  }
};

}  // namespace seqloop::live
