// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>

namespace seqloop::ros {

/// `builtin_interfaces/msg/Time`.
struct Time {
  std::int32_t sec;
  std::uint32_t nanosec;  ///< below a second
};

/// @param time_ns since 1970. What is before or beyond what a Time can say is the nearest that it
///   can: subscribers refuse a message whose seconds are negative
[[nodiscard]] constexpr Time time_of(std::int64_t time_ns) noexcept {
  constexpr std::int64_t second = 1'000'000'000;
  constexpr std::int64_t most =
      (std::int64_t{std::numeric_limits<std::int32_t>::max()} + 1) * second - 1;
  const std::int64_t can_be = std::clamp<std::int64_t>(time_ns, 0, most);
  return {static_cast<std::int32_t>(can_be / second), static_cast<std::uint32_t>(can_be % second)};
}

}  // namespace seqloop::ros
