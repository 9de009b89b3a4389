// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string_view>
#include <type_traits>

#include "seqloop/detail/arena.hpp"

namespace seqloop {

/// The newest columns of a matrix as a ring that is filled where somebody looks. A value is
/// computed at most once. Columns are named by the frame that they belong to. Nothing is done for
/// values that nobody asks for, not even marking them: a frame's cost does not grow with the rows.
/// @tparam Value float, never negative, or uint16, never 65,535
template <class Value>
class ColumnRing {
 public:
  /// What stands where nothing was computed.
  static constexpr Value not_computed =
      std::is_floating_point_v<Value> ? Value(-1) : std::numeric_limits<Value>::max();

  /// @param name, marks what the buffers are called in a plan
  /// @param margin values that may be read before a column's first row and behind its last,
  ///   whatever they are
  /// Allocates: from the arena only.
  ColumnRing(Arena& arena, std::string_view name, std::string_view marks, std::size_t columns,
             std::size_t rows, std::size_t margin)
      : columns_(columns),
        rows_(rows),
        blocks_((rows + block_rows - 1) / block_rows),
        values_(between_margins(
            arena.take<Value>(name, columns > 0 ? std::uint64_t{columns} * rows + 2 * margin : 0),
            margin)),
        block_frames_(arena.take<std::uint64_t>(marks, std::uint64_t{columns} * blocks_)),
        filled_(arena.take<Filled>(marks, columns)) {}

  /// Takes what was computed of the frame before as this frame's too.
  /// @param frame above 0. Work: N copies at most. Allocates: never.
  void repeat(std::uint64_t frame) noexcept {
    if (slot(frame) == slot(frame - 1)) return;
    for (std::size_t block = 0; block < blocks_; ++block) {
      if (block_frame(frame - 1, block) != frame) continue;
      block_frame(frame, block) = frame + 1;
      const std::size_t first = block * block_rows;
      const std::size_t count = std::min(block_rows, rows_ - first);
      std::copy_n(&values_[slot(frame - 1) * rows_ + first], count,
                  &values_[slot(frame) * rows_ + first]);
    }
    filled_[slot(frame)] = {frame + 1, filled_to(frame - 1)};
  }

  /// Makes sure that the rows [first, last) are there.
  /// @param compute (row, out): writes the values of the rows from `row` on
  /// @return how many had to be computed. Work: that many values. Allocates: never.
  template <class Compute>
  std::size_t fill(std::uint64_t frame, std::size_t first, std::size_t last,
                   Compute compute) noexcept {
    const std::size_t filled = filled_to(frame);
    if (last <= filled) return 0;
    std::size_t row = std::max(first, filled);
    begin_blocks(frame, row, last);
    Value* const values = &values_[slot(frame) * rows_];
    std::size_t computed = 0;
    while (row < last) {
      while (row < last && values[row] != not_computed) ++row;
      std::size_t end = row;
      while (end < last && values[end] == not_computed) ++end;
      if (end > row) compute(row, std::span(values + row, end - row));
      computed += end - row;
      row = end;
    }
    if (first <= filled) filled_[slot(frame)] = {frame + 1, last};
    return computed;
  }

  /// The whole column of a frame that nothing was computed of yet, for the caller to write.
  /// @return [rows]. Work: marks.
  [[nodiscard]] std::span<Value> take_over(std::uint64_t frame, std::size_t rows) noexcept {
    begin_blocks(frame, rows / block_rows * block_rows, rows_);
    for (std::size_t block = 0; block < rows / block_rows; ++block) {
      block_frame(frame, block) = frame + 1;
    }
    filled_[slot(frame)] = {frame + 1, rows};
    return values_.subspan(slot(frame) * rows_, rows);
  }

  /// How many of the rows [first, last) `fill` would have to compute.
  [[nodiscard]] std::size_t missing(std::uint64_t frame, std::size_t first,
                                    std::size_t last) const noexcept {
    std::size_t count = 0;
    std::size_t row = std::max(first, filled_to(frame));
    if (row >= last) return 0;
    const std::size_t column = slot(frame);
    const Value* const values = values_.data() + column * rows_;
    while (row < last) {
      const std::size_t block = row / block_rows;
      const std::size_t end = std::min(last, (block + 1) * block_rows);
      if (block_frames_[column * blocks_ + block] != frame + 1) {
        count += end - row;
      } else {
        // As narrow as the values, so that many are counted at once.
        std::uint16_t in_block = 0;
        for (std::size_t r = row; r < end; ++r) {
          in_block = static_cast<std::uint16_t>(in_block + (values[r] == not_computed ? 1 : 0));
        }
        count += in_block;
      }
      row = end;
    }
    return count;
  }

  /// Forgets a row in all columns: it belongs to another place from now on. Work: a mark a column.
  void forget(std::size_t row) noexcept {
    for (std::size_t column = 0; column < columns_; ++column) {
      values_[column * rows_ + row] = not_computed;
      filled_[column].to = std::min(filled_[column].to, row);
    }
  }

  /// @param frame one of the newest `columns` frames
  /// @return [rows], meaningful where filled; `margin` values before and behind may be read too
  [[nodiscard]] const Value* column(std::uint64_t frame) const noexcept {
    return values_.data() + slot(frame) * rows_;
  }

  /// @return a frame's value of a row; `not_computed` where that is so
  [[nodiscard]] Value value(std::uint64_t frame, std::size_t row) const noexcept {
    const bool begun = block_frames_[slot(frame) * blocks_ + row / block_rows] == frame + 1;
    return begun ? values_[slot(frame) * rows_ + row] : not_computed;
  }

 private:
  static constexpr std::size_t block_rows = 32;

  struct Filled {
    std::uint64_t frame;  // whose column it is, and one: 0 is nobody's
    std::size_t to;       // rows before this one are all there
  };

  [[nodiscard]] static std::span<Value> between_margins(std::span<Value> all, std::size_t margin) {
    return all.empty() ? all : all.subspan(margin, all.size() - 2 * margin);
  }

  [[nodiscard]] std::size_t slot(std::uint64_t frame) const noexcept {
    return static_cast<std::size_t>(frame % columns_);
  }
  [[nodiscard]] std::uint64_t& block_frame(std::uint64_t frame, std::size_t block) noexcept {
    return block_frames_[slot(frame) * blocks_ + block];
  }
  [[nodiscard]] std::size_t filled_to(std::uint64_t frame) const noexcept {
    const Filled& filled = filled_[slot(frame)];
    return filled.frame == frame + 1 ? filled.to : 0;
  }

  /// Marks the rows' blocks as not computed where they still hold an older frame's values.
  void begin_blocks(std::uint64_t frame, std::size_t row, std::size_t last) noexcept {
    for (std::size_t block = row / block_rows; block * block_rows < last; ++block) {
      if (block_frame(frame, block) == frame + 1) continue;
      block_frame(frame, block) = frame + 1;
      const std::size_t first = block * block_rows;
      std::fill_n(&values_[slot(frame) * rows_ + first], std::min(block_rows, rows_ - first),
                  not_computed);
    }
  }

  std::size_t columns_;
  std::size_t rows_;
  std::size_t blocks_;
  std::span<Value> values_;                // [columns, rows]
  std::span<std::uint64_t> block_frames_;  // [columns, blocks]: whose values a block holds, and one
  std::span<Filled> filled_;               // [columns]
};

}  // namespace seqloop
