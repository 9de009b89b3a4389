// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "seqloop/detail/arena.hpp"

namespace seqloop {

/// Which slot of the memory each row of the map is in, oldest first. Rows are counted anew whenever
/// one goes; a place keeps its slot and its number for life.
class PlaceOrder {
 public:
  /// Allocates: from the arena only.
  PlaceOrder(Arena& arena, std::size_t slots);

  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  [[nodiscard]] std::size_t capacity() const noexcept { return slots_.size(); }

  /// Whether every row is in the slot of its own number, as until one goes.
  [[nodiscard]] bool straight() const noexcept { return straight_; }

  /// @param row 0 .. size()
  [[nodiscard]] std::size_t slot(std::size_t row) const noexcept {
    return straight_ ? row : slots_[at(row)];
  }

  /// How many places were added before this one.
  [[nodiscard]] std::uint64_t number(std::size_t row) const noexcept { return numbers_[slot(row)]; }

  /// Calls `work(row, slot, count)` for pieces of the rows [first, last) whose slots lie side by
  /// side.
  template <class Work>
  void in_slots(std::size_t first, std::size_t last, Work work) const noexcept {
    while (first < last) {
      const std::size_t begin = slot(first);
      std::size_t end = straight() ? last : first + 1;
      while (end < last && slot(end) == begin + (end - first)) ++end;
      work(first, begin, end - first);
      first = end;
    }
  }

  /// A new newest row. @return its slot; not when full
  std::size_t append() noexcept;

  /// Takes a row out; a new one comes before another may go.
  /// @return its slot, free for the new one
  /// Work: moves the shorter of the two sides, 4 bytes a row. Allocates: never.
  std::size_t remove(std::size_t row) noexcept;

 private:
  [[nodiscard]] std::size_t at(std::size_t row) const noexcept {
    const std::size_t place = begin_ + row;
    return place < slots_.size() ? place : place - slots_.size();
  }

  bool straight_ = true;
  std::size_t begin_ = 0;  // where the oldest row stands in slots_
  std::size_t size_ = 0;
  std::uint64_t added_ = 0;
  std::size_t free_slot_ = 0;         // of a row that went; otherwise the next unused one
  std::span<std::uint32_t> slots_;    // [capacity], a ring
  std::span<std::uint64_t> numbers_;  // [capacity], by slot
};

}  // namespace seqloop
