#pragma once

#include <cstddef>
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
  std::size_t bytes;            ///< that one round reads at least
  std::function<void()> round;  ///< gone once it is timed, with what it holds
  LatencyHistogram times{};
};

/// Times all, in turn, so that a machine that slows down slows all contenders down; then moves them
/// to the end of `timed`.
void time_in_turn(std::vector<Contender> contenders, std::size_t rounds,
                  std::vector<Contender>& timed);

}  // namespace seqloop::program
