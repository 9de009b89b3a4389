// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <bit>
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
  /// What `value` gives where nothing was computed.
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
        marks_(arena.take<Block>(marks, std::uint64_t{columns} * blocks_)),
        filled_(arena.take<Filled>(marks, columns)) {}

  /// Takes what was computed of the frame before as this frame's too.
  /// @param frame above 0. Work: N copies at most. Allocates: never.
  void repeat(std::uint64_t frame) noexcept {
    come_to(frame);
    if (slot(frame) == slot(frame - 1)) return;
    for (std::size_t block = 0; block < blocks_; ++block) {
      const Block& before = mark(frame - 1, block);
      if (before.frame != frame) continue;
      mark(frame, block) = {frame + 1, before.filled};
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
    come_to(frame);
    const std::size_t filled = filled_to(frame);
    if (last <= filled) return 0;
    Value* const values = &values_[slot(frame) * rows_];
    std::size_t computed = 0;
    // What is missing may go on from block to block.
    std::size_t begin = 0;
    std::size_t end = 0;
    const auto compute_missing = [&] {
      if (end > begin) compute(begin, std::span(values + begin, end - begin));
      computed += end - begin;
    };
    for (std::size_t row = std::max(first, filled); row < last;) {
      const Part part = part_of(row, last);
      Block& block = mark(frame, part.block);
      if (block.frame != frame + 1) block = {frame + 1, 0};
      std::uint64_t missing = part.rows & ~block.filled;
      block.filled |= part.rows;
      while (missing != 0) {
        const auto from = static_cast<std::size_t>(std::countr_zero(missing));
        const auto to = from + static_cast<std::size_t>(std::countr_one(missing >> from));
        if (const std::size_t next = part.block * block_rows + from; next != end) {
          compute_missing();
          begin = next;
        }
        end = part.block * block_rows + to;
        missing &= ~rows_before(to);
      }
      row = part.end;
    }
    compute_missing();
    if (first <= filled) filled_[slot(frame)] = {frame + 1, last};
    return computed;
  }

  /// The whole column of a frame that nothing was computed of yet, for the caller to write.
  /// @return [rows]. Work: marks.
  [[nodiscard]] std::span<Value> take_over(std::uint64_t frame, std::size_t rows) noexcept {
    come_to(frame);
    for (std::size_t row = 0; row < rows;) {
      const Part part = part_of(row, rows);
      mark(frame, part.block) = {frame + 1, part.rows};
      row = part.end;
    }
    filled_[slot(frame)] = {frame + 1, rows};
    return values_.subspan(slot(frame) * rows_, rows);
  }

  /// How many of the rows [first, last) `fill` would have to compute.
  [[nodiscard]] std::size_t missing(std::uint64_t frame, std::size_t first,
                                    std::size_t last) const noexcept {
    std::size_t count = 0;
    const Block* const marks = marks_.data() + slot(frame) * blocks_;
    for (std::size_t row = std::max(first, filled_to(frame)); row < last;) {
      const Part part = part_of(row, last);
      const Block& block = marks[part.block];
      const std::uint64_t filled = block.frame == frame + 1 ? block.filled : 0;
      // Mostly nothing is missing, and few processors count bits for all programs.
      const std::uint64_t open = part.rows & ~filled;
      if (open != 0) count += static_cast<std::size_t>(std::popcount(open));
      row = part.end;
    }
    return count;
  }

  /// Forgets a row in all columns: it belongs to another place from now on. Work: a mark a column.
  void forget(std::size_t row) noexcept {
    for (std::size_t column = 0; column < columns_; ++column) {
      marks_[column * blocks_ + row / block_rows].filled &=
          ~(std::uint64_t{1} << (row % block_rows));
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
    const Block& block = marks_[slot(frame) * blocks_ + row / block_rows];
    const bool computed =
        block.frame == frame + 1 && ((block.filled >> (row % block_rows)) & 1) != 0;
    return computed ? values_[slot(frame) * rows_ + row] : not_computed;
  }

 private:
  static constexpr std::size_t block_rows = 64;

  struct Block {
    std::uint64_t frame;   // whose values it holds, and one: 0 is nobody's
    std::uint64_t filled;  // a bit for each row: which of them are there
  };

  struct Filled {
    std::uint64_t frame;  // whose column it is, and one: 0 is nobody's
    std::size_t to;       // rows before this one are all there
  };

  [[nodiscard]] static std::span<Value> between_margins(std::span<Value> all, std::size_t margin) {
    return all.empty() ? all : all.subspan(margin, all.size() - 2 * margin);
  }

  /// frame % columns_, hardly ever by division: a step asks for it a thousand times.
  [[nodiscard]] std::size_t slot(std::uint64_t frame) const noexcept {
    const std::uint64_t since = frame - round_;
    if (since < columns_) return static_cast<std::size_t>(since);
    const std::uint64_t before = since + columns_;
    return static_cast<std::size_t>(before < columns_ ? before : frame % columns_);
  }

  /// A frame will be asked for.
  void come_to(std::uint64_t frame) noexcept {
    if (frame >= round_ + columns_) round_ = frame - frame % columns_;
  }

  [[nodiscard]] Block& mark(std::uint64_t frame, std::size_t block) noexcept {
    return marks_[slot(frame) * blocks_ + block];
  }

  /// The rows of a block below the n-th. @param n 1 .. block_rows
  [[nodiscard]] static std::uint64_t rows_before(std::size_t n) noexcept {
    return ~std::uint64_t{0} >> (block_rows - n);
  }

  /// The rows from one on that lie in its block.
  struct Part {
    std::size_t block;
    std::size_t end;
    std::uint64_t rows;  // as `Block` has them
  };
  [[nodiscard]] static Part part_of(std::size_t row, std::size_t last) noexcept {
    const std::size_t block = row / block_rows;
    const std::size_t end = std::min(last, (block + 1) * block_rows);
    const std::uint64_t from = ~std::uint64_t{0} << (row % block_rows);
    return {block, end, from & rows_before(end - block * block_rows)};
  }

  [[nodiscard]] std::size_t filled_to(std::uint64_t frame) const noexcept {
    const Filled& filled = filled_[slot(frame)];
    return filled.frame == frame + 1 ? filled.to : 0;
  }

  std::size_t columns_;
  std::size_t rows_;
  std::size_t blocks_;
  std::uint64_t round_ = 0;   // first frame of the newest round: a multiple of columns
  std::span<Value> values_;   // [columns, rows]
  std::span<Block> marks_;    // [columns, blocks]
  std::span<Filled> filled_;  // [columns]
};

}  // namespace seqloop
