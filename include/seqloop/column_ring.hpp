#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "seqloop/arena.hpp"

namespace seqloop {

/// The newest columns of a matrix whose values are never negative, as a ring that is filled where
/// somebody looks. A value is computed at most once. Columns are named by the frame that they
/// belong to.
class ColumnRing {
 public:
  /// @param name, marks what the buffers are called in a plan
  /// Allocates: from the arena only.
  ColumnRing(Arena& arena, std::string_view name, std::string_view marks, std::size_t columns,
             std::size_t rows)
      : columns_(columns),
        rows_(rows),
        values_(arena.take<float>(name, columns * rows)),
        filled_to_(arena.take<std::size_t>(marks, columns)) {}

  /// Begins a frame's column, forgetting the oldest. Work: N marks. Allocates: never.
  void begin(std::uint64_t frame) noexcept {
    std::ranges::fill(cells(frame), not_computed);
    filled_to_[slot(frame)] = 0;
  }

  /// Begins a frame's column as a copy of the one before it, what is not computed included.
  /// @param frame above 0. Work: N copies. Allocates: never.
  void repeat(std::uint64_t frame) noexcept {
    if (slot(frame) == slot(frame - 1)) return;
    std::ranges::copy(cells(frame - 1), cells(frame).begin());
    filled_to_[slot(frame)] = filled_to_[slot(frame - 1)];
  }

  /// Makes sure that the rows [first, last) are there.
  /// @param compute value >= 0 of a row
  /// @return how many had to be computed. Work: that many times `compute`. Allocates: never.
  template <class Compute>
  std::size_t fill(std::uint64_t frame, std::size_t first, std::size_t last,
                   Compute compute) noexcept {
    const std::span<float> column = cells(frame);
    std::size_t& filled_to = filled_to_[slot(frame)];
    std::size_t computed = 0;
    for (std::size_t row = std::max(first, filled_to); row < last; ++row) {
      if (column[row] != not_computed) continue;
      column[row] = compute(row);
      ++computed;
    }
    if (first <= filled_to) filled_to = std::max(filled_to, last);
    return computed;
  }

  /// @param frame one of the newest `columns` frames
  /// @return [rows], meaningful where filled
  [[nodiscard]] std::span<const float> column(std::uint64_t frame) const noexcept {
    return values_.subspan(slot(frame) * rows_, rows_);
  }

 private:
  static constexpr float not_computed = -1.0F;

  [[nodiscard]] std::size_t slot(std::uint64_t frame) const noexcept {
    return static_cast<std::size_t>(frame % columns_);
  }
  [[nodiscard]] std::span<float> cells(std::uint64_t frame) noexcept {
    return values_.subspan(slot(frame) * rows_, rows_);
  }

  std::size_t columns_;
  std::size_t rows_;
  std::span<float> values_;           // [columns, rows]
  std::span<std::size_t> filled_to_;  // [columns]: rows before this one are all there
};

}  // namespace seqloop
