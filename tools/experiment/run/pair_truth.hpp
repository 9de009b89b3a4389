// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "evaluation/truth.hpp"
#include "experiment/run/experiment.hpp"

namespace seqloop::experiment {

/// Frames of a pair's drives, as far as they are known.
struct PairLengths {
  std::optional<std::uint64_t> reference;  ///< none where loops are closed
  std::vector<std::optional<std::uint64_t>> queries;

  /// Of all query drives together.
  [[nodiscard]] std::optional<std::uint64_t> query() const;
  /// What becomes the map: the reference, or where loops are closed the query.
  [[nodiscard]] std::optional<std::uint64_t> map(const PairSpec& pair) const;
};

/// The truth of a pair. Identity, where loops are closed, is frame i of every drive after the first
/// showing frame i of the drives before.
/// @param lengths all known where truth is identity
/// Adds faults: files that cannot be read, a truth of frames that the drives do not have, drives of
/// different length whose frames i are said to belong together.
[[nodiscard]] evaluation::Truth pair_truth(const PairSpec& pair, const PairLengths& lengths,
                                           Faults& faults);

/// What is matched with what, and which answers are right, in words for a report.
[[nodiscard]] std::string how_judged(const PairSpec& pair);

}  // namespace seqloop::experiment
