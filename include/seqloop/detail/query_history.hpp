// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "seqloop/detail/arena.hpp"
#include "seqloop/detail/descriptor_rows.hpp"

namespace seqloop {

/// The newest query descriptors, a ring: what the change degree is computed from, and what becomes
/// a place; and what they are compared with the map's places by, which is not the same where
/// frames are moved to the side.
class QueryHistory {
 public:
  /// @param kept  frames whose descriptors are kept, at least 1
  /// @param moves whether frames may be compared with places by other descriptors than their own
  /// Allocates: from the arena only.
  QueryHistory(Arena& arena, const DescriptorForm& form, std::size_t kept, bool moves = false)
      : kept_(kept),
        rows_(arena, {"query descriptors", "lengths of query descriptors", "query sketches"}, form,
              kept),
        moved_(arena, {"moved descriptors", "lengths of moved descriptors", "moved sketches"}, form,
               moves ? kept : 0),
        moves_(moves) {}

  /// Takes the next frame's descriptor, forgetting the oldest.
  /// @param descriptor [D] finite. Work: D. Allocates: never.
  void push(std::span<const float> descriptor) noexcept {
    begin_next();
    rows_.store(newest_row_, descriptor);
    if (moves_) moved_.copy(newest_row_, rows_, newest_row_);
  }

  /// The same, where it may be moved. @param moved [D] finite: what it is compared with places by;
  /// the same memory where it is not moved
  void push(std::span<const float> descriptor, std::span<const float> moved) noexcept {
    if (!moves_ || moved.data() == descriptor.data()) return push(descriptor);
    begin_next();
    rows_.store(newest_row_, descriptor);
    moved_.store(newest_row_, moved);
  }

  /// Takes another frame with the newest one's descriptor, or with none, all zero, if it is the
  /// first. Work: D copies. Allocates: never.
  void push_again() noexcept {
    const std::size_t before = newest_row_;
    begin_next();
    if (frames_ == 1) return;
    rows_.copy(newest_row_, rows_, before);
    if (moves_) moved_.copy(newest_row_, moved_, before);
  }

  /// Frames pushed so far.
  [[nodiscard]] std::uint64_t frames() const noexcept { return frames_; }

  /// The newest frame; there must be one.
  [[nodiscard]] std::uint64_t newest() const noexcept { return frames_ - 1; }

  /// The descriptors that are kept; the row of a frame that is among them is `row_of(frame)`.
  [[nodiscard]] const DescriptorRows& rows() const noexcept { return rows_; }

  /// What they are compared with places by, in the same rows.
  [[nodiscard]] const DescriptorRows& moved() const noexcept { return moves_ ? moved_ : rows_; }

  [[nodiscard]] std::size_t row_of(std::uint64_t frame) const noexcept {
    // The ring is gone round by hand: a step asks for this a thousand times, and division is slow.
    const auto back = static_cast<std::size_t>(newest() - frame);
    return newest_row_ >= back ? newest_row_ - back : newest_row_ + kept_ - back;
  }

  /// The difference of two frames that are kept. Work: D MACs.
  [[nodiscard]] double between(std::uint64_t a, std::uint64_t b) const noexcept {
    return rows_.between(row_of(a), row_of(b));
  }

 private:
  void begin_next() noexcept {
    const bool goes_on = frames_++ > 0 && newest_row_ + 1 < kept_;
    newest_row_ = goes_on ? newest_row_ + 1 : 0;
  }

  std::size_t kept_;
  std::uint64_t frames_ = 0;
  std::size_t newest_row_ = 0;
  DescriptorRows rows_;   // [kept]
  DescriptorRows moved_;  // [kept], or none
  bool moves_;
};

}  // namespace seqloop
