// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <optional>
#include <span>

#include "seqloop/detail/arena.hpp"
#include "seqloop/detail/candidate_runs.hpp"

namespace seqloop {

/// Which slot of the memory each row of the map is in, oldest first, and which rows are of one
/// session. Rows are counted anew whenever one goes; a place keeps its slot and its number for
/// life.
class PlaceOrder {
 public:
  /// @param sessions that there is room for; 1 or more. Allocates: from the arena only.
  PlaceOrder(Arena& arena, std::size_t slots, std::size_t sessions);

  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  [[nodiscard]] std::size_t capacity() const noexcept { return slots_.size(); }

  /// Whether every row is in the slot that it counts, as until one goes.
  [[nodiscard]] bool straight() const noexcept { return straight_; }

  /// @param row 0 .. size()
  [[nodiscard]] std::size_t slot(std::size_t row) const noexcept {
    return straight_ ? row : slots_[at(row)];
  }

  /// The place's number: more than that of the place that was added before it, by one or as given.
  [[nodiscard]] std::uint64_t number(std::size_t row) const noexcept { return numbers_[slot(row)]; }

  /// The number that the next place gets, unless one is given.
  [[nodiscard]] std::uint64_t next_number() const noexcept { return next_; }

  /// The next place gets this number, or a higher one if that is its turn.
  void count_from(std::uint64_t number) noexcept { next_ = std::max(next_, number); }

  /// The frame of its session that the place is.
  [[nodiscard]] std::uint64_t frame(std::size_t row) const noexcept { return frames_[slot(row)]; }

  /// Rows that are appended from here on are of another session. While the newest has no row, it
  /// is that one.
  /// @return false when there is no room for one more. Allocates: never.
  bool begin_session() noexcept;

  [[nodiscard]] bool has_room_for_session() const noexcept {
    return sessions_ < begins_.size() || begins_[sessions_ - 1].row == size_;
  }

  /// Sessions that there is room for.
  [[nodiscard]] std::size_t most_sessions() const noexcept { return begins_.size(); }

  /// Sessions that have been begun, those whose rows have all gone too; 1 or more.
  [[nodiscard]] std::size_t sessions() const noexcept { return sessions_; }

  /// The rows of a session. @param session 0 .. sessions()
  [[nodiscard]] CandidateRun session(std::size_t session) const noexcept {
    return {begins_[session].row, session + 1 < sessions_ ? begins_[session + 1].row : size_};
  }

  /// The rows of the session that was begun last.
  [[nodiscard]] CandidateRun newest_session() const noexcept { return session(sessions_ - 1); }

  /// The session that a row is of; the newest for one beyond the last. Work: log sessions.
  [[nodiscard]] std::size_t session_of(std::size_t row) const noexcept {
    return sessions_ == 1 ? 0 : last_begun(row, &Begin::row);
  }

  /// The session that a place is of or, if it has gone, was. Work: log sessions.
  [[nodiscard]] std::size_t session_of_number(std::uint64_t number) const noexcept;

  /// The rows of the session that a row is of.
  [[nodiscard]] CandidateRun around(std::size_t row) const noexcept {
    return session(session_of(row));
  }

  /// Rows from one to the other; `far` between two sessions.
  [[nodiscard]] std::size_t apart(std::size_t a, std::size_t b) const noexcept {
    if (sessions_ > 1 && session_of(a) != session_of(b)) return far;
    return a < b ? b - a : a - b;
  }
  static constexpr std::size_t far = static_cast<std::size_t>(-1);

  /// The row that lies this many rows before another, or the first of its session.
  [[nodiscard]] std::size_t before(std::size_t row, std::size_t by) const noexcept {
    return std::max(around(row).first, row - std::min(row, by));
  }

  /// The first row of the newest session whose frame is this one or later; size() if there is none.
  /// Work: log N.
  [[nodiscard]] std::size_t row_of_frame(std::uint64_t frame) const noexcept;

  /// The row of the place with a number; none where it has gone. Work: log N.
  [[nodiscard]] std::optional<std::size_t> row_of_number(std::uint64_t number) const noexcept;

  /// Calls `work(part)` for the parts of a run that are of one session each, in rising order.
  template <class Work>
  void in_sessions(CandidateRun run, Work work) const noexcept {
    while (run.first < run.last) {
      const std::size_t end = std::min(run.last, around(run.first).last);
      work(CandidateRun{run.first, end});
      run.first = end;
    }
  }

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

  /// A new newest row. @param frame of its session, above that of the row before it
  /// @return its slot; not when full
  std::size_t append(std::uint64_t frame) noexcept { return append(frame, next_); }

  /// @param number `next_number()` or more
  std::size_t append(std::uint64_t frame, std::uint64_t number) noexcept;

  /// A new last row of a session that need not be the newest; those behind it are counted anew.
  /// @param session that has rows @param frame, number above those of its last row; the number
  /// below
  ///   that of the next session's first
  /// @return its slot, as `next_slot` said; not when full
  /// Work: moves the shorter of the two sides, 4 bytes a row, and looks at each session.
  /// Allocates: never.
  std::size_t insert(std::size_t session, std::uint64_t frame, std::uint64_t number) noexcept;

  /// The slot that the next new row gets.
  [[nodiscard]] std::size_t next_slot() const noexcept { return free_slot_; }

  /// Numbers that a session may give: above those of its rows, below those of the next session.
  /// @return whether this is one
  [[nodiscard]] bool may_give(std::size_t session, std::uint64_t number) const noexcept;

  /// Takes a row out; a new one comes before another may go.
  /// @return its slot, free for the new one
  /// Work: moves the shorter of the two sides, 4 bytes a row, and looks at each session.
  /// Allocates: never.
  std::size_t remove(std::size_t row) noexcept;

 private:
  [[nodiscard]] std::size_t at(std::size_t row) const noexcept {
    const std::size_t place = begin_ + row;
    return place < slots_.size() ? place : place - slots_.size();
  }

  /// Where a session begins.
  struct Begin {
    std::size_t row;
    std::uint64_t number;
  };

  /// The last session that begins at this value or before it. @param by what sessions rise in
  template <class Value>
  [[nodiscard]] std::size_t last_begun(Value value, Value Begin::*by) const noexcept {
    const auto later = begins_.first(sessions_).subspan(1);
    const auto behind = std::ranges::upper_bound(later, value, {}, by);
    return static_cast<std::size_t>(std::distance(later.begin(), behind));
  }

  bool straight_ = true;
  std::size_t begin_ = 0;  // where the oldest row stands in slots_
  std::size_t size_ = 0;
  std::uint64_t next_ = 0;
  std::size_t sessions_ = 1;
  std::size_t free_slot_ = 0;         // of a row that went; otherwise the next unused one
  std::span<std::uint32_t> slots_;    // [capacity], a ring
  std::span<std::uint64_t> numbers_;  // [capacity], by slot
  std::span<std::uint64_t> frames_;   // [capacity], by slot
  std::span<Begin> begins_;           // [room for sessions]
};

}  // namespace seqloop
