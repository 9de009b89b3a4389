// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>

#include "evaluation/truth.hpp"
#include "experiment/run/experiment.hpp"

namespace seqloop::experiment {

/// Frames of a pair's drives, as far as they are known.
struct PairLengths {
  std::optional<std::uint64_t> reference;  ///< closing loops: the query's
  std::optional<std::uint64_t> query;
};

/// The truth of a pair. @param lengths both known where truth is identity
/// Adds faults: files that cannot be read, a truth of frames that the drives do not have, drives of
/// different length whose frames i are said to belong together.
[[nodiscard]] evaluation::Truth pair_truth(const PairSpec& pair, const PairLengths& lengths,
                                           Faults& faults);

}  // namespace seqloop::experiment
