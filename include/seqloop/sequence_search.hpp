#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "seqloop/arena.hpp"
#include "seqloop/candidate_ranges.hpp"
#include "seqloop/difference_slices.hpp"
#include "seqloop/integer_kernels.hpp"
#include "seqloop/place_order.hpp"
#include "seqloop/trajectories.hpp"

namespace seqloop {

/// Scores rows of the map by the straight lines through them. Source: Algorithm 2, D3.
///
/// A line runs along diagonals of velocity 1 and changes from one to the next |m - ds| times. Sums
/// that begin at the window's first column are kept for every diagonal of a block of rows; each
/// piece of a line is then one add and one subtract, ds + 1 adds become 2 (|m - ds| + 1). Whole
/// numbers have the same sum in any order; floats are summed in double, which has room for all
/// their digits unless they differ in size by more than a million.
class SequenceSearch {
 public:
  /// Allocates: from the arena only.
  SequenceSearch(Arena& arena, const Trajectories& trajectories, const MatcherConfig& config,
                 std::size_t places);

  /// Scores every row of a run: `score(q) = min over valid lines of the mean of D along the line`;
  /// a line is valid when all its rows are in [0, rows). The slowest of equal lines wins.
  /// @param slices filled where valid lines through the run can go
  /// @param oldest frame of the window's first column
  /// @param rows   rows of the map that lines may touch
  /// @return lines summed. Work: per row, ds + 1 adds and 2 (|m - ds| + 1) for each line.
  /// Allocates: never.
  std::size_t score(const DifferenceSlices& slices, const PlaceOrder& order, std::uint64_t oldest,
                    CandidateRun run, std::size_t rows) noexcept;

  /// @return [places] mean difference 0 .. 2, infinity where no line was valid; only rows of this
  /// frame's runs mean anything
  [[nodiscard]] std::span<const double> scores() const noexcept { return scores_; }

  /// @return the line that gave a row its score
  [[nodiscard]] std::size_t line(std::size_t row) const noexcept { return lines_[row]; }

 private:
  template <class Value, class Sum>
  std::size_t score_block(const DifferenceSlices& slices, const PlaceOrder& order,
                          std::uint64_t oldest, CandidateRun block, std::size_t rows,
                          std::span<Sum> sums, std::span<Sum> lowest) noexcept;
  template <class Value, class Sum>
  void add_up(const DifferenceSlices& slices, const PlaceOrder& order, std::uint64_t oldest,
              CandidateRun block, std::size_t rows, std::span<Sum> sums) const noexcept;
  void lowest_of(std::span<const double> sums, std::size_t line, CandidateRun part,
                 std::span<double> lowest) noexcept;
  void lowest_of(std::span<const std::uint32_t> sums, std::size_t line, CandidateRun part,
                 std::span<std::uint32_t> lowest) noexcept;
  [[nodiscard]] std::span<const LineSegment> segments(std::size_t line) const noexcept {
    return segments_.subspan(line_begins_[line], line_begins_[line + 1] - line_begins_[line]);
  }

  const Trajectories* trajectories_;
  const IntegerKernels* kernels_;
  std::size_t below_ = 0;                  // how many diagonals below a row's own its lines can go
  std::size_t stride_ = 0;                 // diagonals of a block
  std::span<double> scores_;               // [places]
  std::span<std::uint32_t> lines_;         // [places]
  std::span<LineSegment> segments_;        // of all lines
  std::span<std::uint32_t> line_begins_;   // [lines + 1], in segments_
  std::span<std::uint32_t> whole_sums_;    // [ds + 2, stride], whole numbers
  std::span<std::uint32_t> whole_lowest_;  // [block_rows]
  std::span<double> sums_;                 // the same for floats
  std::span<double> lowest_;
  std::span<std::uint32_t> block_lines_;  // [block_rows]
};

}  // namespace seqloop
