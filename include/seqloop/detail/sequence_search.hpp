// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "seqloop/detail/arena.hpp"
#include "seqloop/detail/candidate_ranges.hpp"
#include "seqloop/detail/difference_slices.hpp"
#include "seqloop/detail/float_kernels.hpp"
#include "seqloop/detail/integer_kernels.hpp"
#include "seqloop/detail/place_order.hpp"
#include "seqloop/detail/trajectories.hpp"

namespace seqloop {

/// Scores rows of the map by the straight lines through them. Source: Algorithm 2;
/// src/README.md, sections 3.4 and 4.3.
///
/// A line runs along diagonals of velocity 1 and changes from one to the next |m - ds| times. For a
/// block of rows, every diagonal is summed up from end to end, and so is, up to each column, what
/// neighbouring ones have apart. A line is then the sum of the diagonal that it ends on and, for
/// each change, what the two had apart until then: ds + 1 adds become |m - ds| + 1. Whole numbers
/// have the same sum in any order; floats are summed in double, which has room for all their digits
/// unless they differ in size by more than a million.
class SequenceSearch {
 public:
  /// Allocates: from the arena only.
  SequenceSearch(Arena& arena, const Trajectories& trajectories, const MatcherConfig& config,
                 std::size_t places);

  /// Scores every row of a run: `score(q) = min over valid lines of the mean of D along the line`;
  /// a line is valid when all its rows are in [0, rows) and of one session. The slowest of equal
  /// lines wins.
  /// @param slices filled where valid lines through the run can go
  /// @param oldest frame of the window's first column
  /// @param rows   rows of the map that lines may touch
  /// @return lines summed. Work: per row, 3 (ds + 1) adds and |m - ds| + 1 for each line.
  /// Allocates: never.
  std::size_t score(const DifferenceSlices& slices, const PlaceOrder& order, std::uint64_t oldest,
                    CandidateRun run, std::size_t rows) noexcept;

  /// @return [places] mean difference 0 .. 2, infinity where no line was valid; only rows of this
  /// frame's runs mean anything
  [[nodiscard]] std::span<const double> scores() const noexcept { return scores_; }

  /// @return the line that gave a row its score
  [[nodiscard]] std::size_t line(std::size_t row) const noexcept { return lines_[row]; }

 private:
  struct LineRun {
    std::size_t first;
    std::size_t last;
  };

  /// Where differences of a window are.
  template <class Value>
  struct Columns {
    std::span<const Value*> begins;  // [window], by slot of the map
    std::span<const Value*> values;  // [window], of a block's first diagonal
    std::span<Value> in_order;       // [window, stride + 1], where slots are not in order

    void take(Arena& arena, std::size_t window, std::size_t stride, bool gathered);
  };

  template <class Value, class Sum>
  std::size_t score_run(const DifferenceSlices& slices, const PlaceOrder& order,
                        std::uint64_t oldest, CandidateRun run, CandidateRun session, double scale,
                        Columns<Value>& columns, std::span<Sum> sums,
                        std::span<Sum> lowest) noexcept;
  template <class Sum>
  std::size_t score_block(CandidateRun block, CandidateRun session, double scale,
                          std::span<const Sum> sums, std::span<Sum> lowest) noexcept;
  template <class Value, class Sum>
  void add_up(const PlaceOrder& order, CandidateRun block, Columns<Value>& columns,
              std::span<Sum> sums) noexcept;
  template <class Sum>
  void keep_lowest(std::span<const Sum> sums, LineRun lines, CandidateRun part,
                   std::span<Sum> lowest) noexcept;

  [[nodiscard]] const IntegerKernels& kernels(std::uint32_t /*kind*/) const noexcept {
    return *kernels_;
  }
  [[nodiscard]] const FloatKernels& kernels(double /*kind*/) const noexcept {
    return *float_kernels_;
  }

  const Trajectories* trajectories_;
  const IntegerKernels* kernels_;
  const FloatKernels* float_kernels_;
  std::size_t below_ = 0;                  // how far below a row's own diagonal its lines can go
  std::size_t around_ = 0;                 // diagonals of a block beside its rows' own
  std::size_t stride_ = 0;                 // diagonals of a block, whole vectors
  std::span<double> scores_;               // [places]
  std::span<std::uint32_t> lines_;         // [places]
  std::span<LineThroughSums> through_;     // [lines]
  std::span<std::uint32_t> changes_;       // of all lines
  std::span<std::uint32_t> whole_sums_;    // [ds + 1, stride], whole numbers
  std::span<std::uint32_t> whole_lowest_;  // [block_rows]
  Columns<std::uint16_t> whole_columns_;
  std::span<double> sums_;  // the same for floats
  std::span<double> lowest_;
  Columns<float> columns_;
  std::span<std::uint32_t> block_lines_;  // [block_rows]
};

}  // namespace seqloop
