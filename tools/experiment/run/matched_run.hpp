// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "experiment/run/experiment.hpp"
#include "seqloop/files/npy_file.hpp"

namespace seqloop::experiment {

/// The descriptors of a pair of drives.
struct DescribedPair {
  std::optional<files::Matrix> reference;  ///< none: loops are closed within the query
  files::Matrix query;
  std::vector<std::uint64_t> query_lengths;  ///< rows of it that each query drive has
};

/// What one pass of the detector over a drive gave.
struct MatchedRun {
  std::vector<evaluation::Answer> answers;
  double distances = 0.0;  ///< a frame, mean
  std::uint64_t most_distances = 0;
  double candidates = 0.0;               ///< a frame that was searched, mean
  double seconds = 0.0;                  ///< of all steps
  std::vector<std::uint8_t> matrix_png;  ///< empty unless asked for
};

/// Matches a drive as `seqloop match` does. Memory: both drives, the map and the detector.
/// Throws SetupError, and when the program is interrupted.
[[nodiscard]] MatchedRun match_pair(const RunSpec& run, DescribedPair pair, bool with_matrix);

}  // namespace seqloop::experiment
