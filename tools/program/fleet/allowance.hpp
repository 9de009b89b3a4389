// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>

namespace seqloop::program {

/// What may still be sent, so that it is a given number of kilobits a second on average, and no
/// more than one second's at a time.
class Allowance {
 public:
  using Clock = std::chrono::steady_clock;

  /// @param kbps 0: there is no limit
  explicit Allowance(double kbps, Clock::time_point now = Clock::now())
      : a_second_(kbps * 1000.0 / 8.0), bytes_(a_second_), since_(now) {}

  /// Whether something may be sent. What is sent then may be larger than what was left: later
  /// things wait for it.
  [[nodiscard]] bool left(Clock::time_point now = Clock::now()) noexcept {
    const std::chrono::duration<double> passed = now - since_;
    since_ = now;
    bytes_ = std::min(bytes_ + passed.count() * a_second_, a_second_);
    return a_second_ == 0.0 || bytes_ > 0.0;
  }

  void spend(std::size_t bytes) noexcept { bytes_ -= static_cast<double>(bytes); }

 private:
  double a_second_;
  double bytes_;
  Clock::time_point since_;
};

}  // namespace seqloop::program
