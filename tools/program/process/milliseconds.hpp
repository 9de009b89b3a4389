// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>

#include "seqloop/clock.hpp"

namespace seqloop::program {

/// As people and JSON lines are told times.
[[nodiscard]] inline double milliseconds(Nanoseconds duration) noexcept {
  return std::chrono::duration<double, std::milli>(duration).count();
}

}  // namespace seqloop::program
