// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <cstdint>

namespace seqloop::ros {

/// Now, as ROS 2 stamps it: nanoseconds since 1970. Allocates: never.
[[nodiscard]] inline std::int64_t wall_ns() noexcept {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::nanoseconds>(now).count();
}

}  // namespace seqloop::ros
