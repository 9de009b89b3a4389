// SPDX-License-Identifier: MIT
#include "seqloop/detail/place_order.hpp"

#include <algorithm>

namespace seqloop {
namespace {

/// The first row of a run from which on `holds`; its end if there is none. Work: log rows.
template <class Holds>
std::size_t first_row(CandidateRun run, Holds holds) noexcept {
  while (run.first < run.last) {
    const std::size_t middle = run.first + (run.last - run.first) / 2;
    if (holds(middle)) {
      run.last = middle;
    } else {
      run.first = middle + 1;
    }
  }
  return run.first;
}

}  // namespace

PlaceOrder::PlaceOrder(Arena& arena, std::size_t slots, std::size_t sessions)
    : slots_(arena.take<std::uint32_t>("order of places", slots)),
      numbers_(arena.take<std::uint64_t>("numbers of places", slots)),
      frames_(arena.take<std::uint64_t>("frames of places", slots)),
      begins_(arena.take<Begin>("beginnings of sessions", sessions)) {}

bool PlaceOrder::begin_session() noexcept {
  if (!has_room_for_session()) return false;
  if (begins_[sessions_ - 1].row == size_) return true;
  begins_[sessions_++] = {size_, next_};
  return true;
}

std::size_t PlaceOrder::session_of_number(std::uint64_t number) const noexcept {
  return last_begun(number, &Begin::number);
}

std::size_t PlaceOrder::row_of_frame(std::uint64_t frame) const noexcept {
  return first_row(session(sessions_ - 1),
                   [&](std::size_t row) { return this->frame(row) >= frame; });
}

std::optional<std::size_t> PlaceOrder::row_of_number(std::uint64_t number) const noexcept {
  const std::size_t row =
      first_row({0, size_}, [&](std::size_t r) { return this->number(r) >= number; });
  if (row == size_ || this->number(row) != number) return std::nullopt;
  return row;
}

std::size_t PlaceOrder::append(std::uint64_t frame, std::uint64_t number) noexcept {
  return insert(sessions_ - 1, frame, number);
}

std::size_t PlaceOrder::insert(std::size_t session, std::uint64_t frame,
                               std::uint64_t number) noexcept {
  const std::size_t row = this->session(session).last;
  straight_ = straight_ && row == size_;
  const std::size_t slot = free_slot_;
  if (row < size_ / 2) {
    begin_ = begin_ == 0 ? slots_.size() - 1 : begin_ - 1;
    for (std::size_t r = 0; r < row; ++r) slots_[at(r)] = slots_[at(r + 1)];
  } else {
    for (std::size_t r = size_; r > row; --r) slots_[at(r)] = slots_[at(r - 1)];
  }
  slots_[at(row)] = static_cast<std::uint32_t>(slot);
  numbers_[slot] = number;
  frames_[slot] = frame;
  ++size_;
  free_slot_ = size_;
  count_from(number + 1);
  // Those behind this one may have been begun, and have no row yet.
  for (Begin& begin : begins_.first(sessions_).subspan(session + 1)) ++begin.row;
  return slot;
}

bool PlaceOrder::may_give(std::size_t session, std::uint64_t number) const noexcept {
  if (session + 1 == sessions_) return number >= next_;
  const CandidateRun rows = this->session(session);
  return rows.first < rows.last && number > this->number(rows.last - 1) &&
         number < begins_[session + 1].number;
}

std::size_t PlaceOrder::remove(std::size_t row) noexcept {
  straight_ = false;
  const std::size_t slot = slots_[at(row)];
  if (row < size_ / 2) {
    for (std::size_t r = row; r > 0; --r) slots_[at(r)] = slots_[at(r - 1)];
    begin_ = at(1);
  } else {
    for (std::size_t r = row; r + 1 < size_; ++r) slots_[at(r)] = slots_[at(r + 1)];
  }
  --size_;
  free_slot_ = slot;
  for (Begin& begin : begins_.first(sessions_)) {
    if (begin.row > row) --begin.row;
  }
  return slot;
}

}  // namespace seqloop
