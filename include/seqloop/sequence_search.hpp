#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "seqloop/arena.hpp"
#include "seqloop/candidate_ranges.hpp"
#include "seqloop/difference_slices.hpp"
#include "seqloop/trajectories.hpp"

namespace seqloop {

/// Scores rows of the map by the straight lines through them. Source: Algorithm 2, D3.
class SequenceSearch {
 public:
  /// Allocates: from the arena only.
  SequenceSearch(Arena& arena, const Trajectories& trajectories, std::size_t places);

  /// Scores every row of a run: `score(q) = min over valid lines of the mean of D along the line`;
  /// a line is valid when all its rows are in [0, rows). The slowest of equal lines wins.
  /// @param slices filled where valid lines through the run can go
  /// @param oldest frame of the window's first column
  /// @param rows   rows of the map that lines may touch
  /// @return lines summed. Work: that many times ds + 1 adds. Allocates: never.
  std::size_t score(const DifferenceSlices& slices, std::uint64_t oldest, CandidateRun run,
                    std::size_t rows) noexcept;

  /// @return [places] mean difference 0 .. 2, infinity where no line was valid; only rows of this
  /// frame's runs mean anything
  [[nodiscard]] std::span<const float> scores() const noexcept { return scores_; }

  /// @return the line that gave a row its score
  [[nodiscard]] std::size_t line(std::size_t row) const noexcept { return lines_[row]; }

 private:
  std::size_t score_line(CandidateRun block, std::size_t line, std::size_t rows) noexcept;
  template <int Rows>
  void score_tiles(CandidateRun run, std::size_t line) noexcept;

  const Trajectories* trajectories_;
  std::span<float> scores_;          // [places]
  std::span<std::uint32_t> lines_;   // [places]
  std::span<const float*> columns_;  // [ds + 1], where the window's columns start in this frame
};

}  // namespace seqloop
