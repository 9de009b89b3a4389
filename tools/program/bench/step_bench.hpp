// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "program/bench/contender.hpp"
#include "seqloop/matcher_config.hpp"

namespace seqloop::program {

/// A way to match that is timed.
struct TimedMethod {
  std::string by;
  MatcherConfig config;
};

/// Exhaustive search by int8, O-SeqCNNSLAM with relocalising, and exhaustive search by float.
/// @param ds sequence length @param relocalise_s seconds of driving in which all places are looked
/// at by relocalising, as `run` takes them
[[nodiscard]] std::vector<TimedMethod> timed_methods(std::size_t ds, double relocalise_s,
                                                     std::size_t places);

/// Whole steps of a drive through a map of synthetic places. What a step reads is the mean.
/// Methods that fit half of the available memory together take turns; what does not fit alone is
/// left out, and it is said.
void time_steps(const Capacity& size, std::size_t ds, double relocalise_s, std::size_t rounds,
                std::vector<Contender>& timed);

}  // namespace seqloop::program
