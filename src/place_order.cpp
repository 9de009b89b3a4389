// SPDX-License-Identifier: MIT
#include "seqloop/detail/place_order.hpp"

#include <algorithm>
#include <iterator>

namespace seqloop {

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

std::size_t PlaceOrder::session_of(std::size_t row) const noexcept {
  if (sessions_ == 1) return 0;
  const auto begins = begins_.first(sessions_);
  const auto behind = std::ranges::upper_bound(begins.subspan(1), row, {}, &Begin::row);
  return static_cast<std::size_t>(std::distance(begins.subspan(1).begin(), behind));
}

std::size_t PlaceOrder::session_of_number(std::uint64_t number) const noexcept {
  if (sessions_ == 1) return 0;
  const auto begins = begins_.first(sessions_);
  const auto behind = std::ranges::upper_bound(begins.subspan(1), number, {}, &Begin::number);
  return static_cast<std::size_t>(std::distance(begins.subspan(1).begin(), behind));
}

std::size_t PlaceOrder::apart(std::size_t a, std::size_t b) const noexcept {
  if (sessions_ > 1 && session_of(a) != session_of(b)) return far;
  return a < b ? b - a : a - b;
}

std::size_t PlaceOrder::row_of_frame(std::uint64_t frame) const noexcept {
  auto [first, last] = session(sessions_ - 1);
  while (first < last) {
    const std::size_t middle = first + (last - first) / 2;
    if (this->frame(middle) < frame) {
      first = middle + 1;
    } else {
      last = middle;
    }
  }
  return first;
}

std::optional<std::size_t> PlaceOrder::row_of_number(std::uint64_t number) const noexcept {
  std::size_t first = 0;
  std::size_t last = size_;
  while (first < last) {
    const std::size_t middle = first + (last - first) / 2;
    if (this->number(middle) < number) {
      first = middle + 1;
    } else {
      last = middle;
    }
  }
  if (first == size_ || this->number(first) != number) return std::nullopt;
  return first;
}

std::size_t PlaceOrder::append(std::uint64_t frame, std::uint64_t number) noexcept {
  const std::size_t slot = free_slot_;
  slots_[at(size_)] = static_cast<std::uint32_t>(slot);
  numbers_[slot] = number;
  frames_[slot] = frame;
  next_ = number + 1;
  ++size_;
  free_slot_ = size_;
  return slot;
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
