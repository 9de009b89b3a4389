// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>

namespace seqloop {

using Nanoseconds = std::chrono::nanoseconds;

/// Port: the only way in which the library learns what time it is. Time measures and paces; no
/// answer depends on it.
class Clock {
 public:
  Clock() = default;
  Clock(const Clock&) = delete;
  Clock& operator=(const Clock&) = delete;
  Clock(Clock&&) = delete;
  Clock& operator=(Clock&&) = delete;
  virtual ~Clock() = default;

  /// Since some fixed moment; never goes back.
  [[nodiscard]] virtual Nanoseconds now() noexcept = 0;

  /// Returns when `now()` has reached the moment, at once if it has.
  virtual void sleep_until(Nanoseconds moment) noexcept = 0;
};

}  // namespace seqloop
