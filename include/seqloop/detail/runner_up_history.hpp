// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "seqloop/detail/arena.hpp"
#include "seqloop/detail/candidate_runs.hpp"
#include "seqloop/matcher_config.hpp"

namespace seqloop {

/// Rows that looked good at the last frames. A frame that scans a part of a large map sees only
/// some of the rows that come close to its best one, and would be too sure of it; the frames
/// before, whose windows overlap with its own, saw the others. Source: src/README.md,
/// section 5.6.
class RunnerUpHistory {
 public:
  /// Allocates: from the arena only.
  RunnerUpHistory(Arena& arena, const MatcherConfig& config);

  struct RunnerUp {
    std::size_t row;
    double score;
  };

  /// Begins a frame. What is remembered is taken to have moved along with it, a row a frame.
  void next() noexcept { ++now_; }

  /// @param best        the frame's best row
  /// @param half_rwindow rows around it that cannot be the runner-up
  /// @param rows        rows of the map that may be searched: where one scan takes them all, the
  /// frame has seen every one of them itself
  /// @param among       rows that count: those of the best row's session
  /// @return the lowest score of the last frames' rows; none where there is none
  /// Work: ds rows at most. Allocates: never.
  [[nodiscard]] std::optional<double> lowest(std::size_t best, std::size_t half_rwindow,
                                             std::size_t rows, CandidateRun among) const noexcept;

  /// Remembers a row of this frame, at most two of them.
  void remember(RunnerUp row) noexcept;

  /// Frames went by unseen.
  void skip(std::uint64_t frames) noexcept { now_ += frames; }

  /// A row went from the map: those behind it are counted one lower. Work: ds.
  void removed(std::size_t row) noexcept;

  /// A row came into the map: those from it on are counted one higher.
  void inserted(std::size_t row) noexcept;

  /// Forgets everything.
  void restart() noexcept { remembered_ = 0; }

 private:
  struct Seen {
    std::uint64_t frame;
    RunnerUp row;
  };

  std::size_t rows_a_scan_;
  std::uint64_t now_ = 0;
  std::uint64_t remembered_ = 0;  // ever, since the last restart
  std::span<Seen> seen_;          // [ds], a ring
};

}  // namespace seqloop
