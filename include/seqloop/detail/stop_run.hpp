// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>

namespace seqloop {

/// A stop: a run of places of a map, or of steps of a drive, at which the robot stood. It stood for
/// long at one of them at least; one in a row at most looked new nevertheless. Source:
/// src/README.md, section 5.12.
struct StopRun {
  std::uint64_t first;
  std::uint64_t last;  ///< of it

  /// Frames after the first that it stands for where it does so for long.
  static constexpr std::uint64_t long_stop = 4;
  /// How far one is from the next at most.
  static constexpr std::uint64_t between = 2;
  /// How far from where it stands for long a stop is asked for at most.
  static constexpr std::uint64_t beside = 3;
  /// How far the stop reaches from there at most.
  static constexpr std::uint64_t reach = 10;

  /// The stop at or beside one.
  /// @param begin, end of those that may be part of it   @param stood frames after the first at one
  /// Work: `beside` and `reach` of them at most, either way. Allocates: never.
  template <class Stood>
  [[nodiscard]] static std::optional<StopRun> around(std::uint64_t at, std::uint64_t begin,
                                                     std::uint64_t end, Stood stood) noexcept {
    const auto stands_long = [&](std::uint64_t one) {
      return one >= begin && one < end && stood(one) >= long_stop;
    };
    std::uint64_t off = 0;
    while (off <= beside && !stands_long(at + off) && !stands_long(at - off)) ++off;
    if (off > beside) return std::nullopt;
    const std::uint64_t found = stands_long(at + off) ? at + off : at - off;
    StopRun run{found, found};
    for (std::uint64_t one = found + 1; one < end && one - run.last <= between; ++one) {
      if (stood(one) > 0) run.last = one;
    }
    for (std::uint64_t one = found; one-- > begin && run.first - one <= between;) {
      if (stood(one) > 0) run.first = one;
    }
    return run;
  }
};

}  // namespace seqloop
