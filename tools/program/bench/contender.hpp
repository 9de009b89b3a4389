// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "seqloop/latency_histogram.hpp"

namespace seqloop::program {

/// Something that is timed.
struct Contender {
  std::string what;
  std::string by;
  std::size_t places;
  std::size_t descriptor_size;
  std::uint64_t bytes;              ///< that one round reads at least
  std::function<void()> round;      ///< gone once it is timed, with what it holds
  std::function<void()> prepare{};  ///< what comes before each round and is not timed; may be none
  LatencyHistogram times{};
};

/// How many rounds a contender makes before it is the next one's turn.
struct Turn {
  /// These do not count: they find in the caches what another contender left there.
  std::size_t untimed = 3;
  std::size_t timed = 4;
};

/// Times all, in turn, so that a machine that slows down slows all contenders down; then moves them
/// to the end of `timed`. A contender that has taken 20 seconds makes no further rounds.
void time_in_turn(std::vector<Contender> contenders, std::size_t rounds,
                  std::vector<Contender>& timed, Turn turn = {});

}  // namespace seqloop::program
