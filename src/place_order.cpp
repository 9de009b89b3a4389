// SPDX-License-Identifier: MIT
#include "seqloop/detail/place_order.hpp"

namespace seqloop {

PlaceOrder::PlaceOrder(Arena& arena, std::size_t slots)
    : slots_(arena.take<std::uint32_t>("order of places", slots)),
      numbers_(arena.take<std::uint64_t>("numbers of places", slots)) {}

std::size_t PlaceOrder::append() noexcept {
  const std::size_t slot = free_slot_;
  slots_[at(size_)] = static_cast<std::uint32_t>(slot);
  numbers_[slot] = added_++;
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
  return slot;
}

}  // namespace seqloop
