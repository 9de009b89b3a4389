// SPDX-License-Identifier: MIT
#include "program/fleet/same_places.hpp"

#include <algorithm>
#include <utility>

namespace seqloop::program {
SamePlaces::SamePlaces(PlaceMap& map, std::uint64_t away)
    : map_(&map), away_(away), next_(map.capacity()) {}

void SamePlaces::added(std::size_t row) noexcept {
  next_[map_->order().slot(row)] = map_->order().number(row);
}

void SamePlaces::join(std::uint64_t one, std::uint64_t other) noexcept {
  const PlaceOrder& order = map_->order();
  const auto row = order.row_of_number(one);
  const auto other_row = order.row_of_number(other);
  if (!row || !other_row) return;
  const auto [first, last] = std::minmax({map_->first_visit(*row), map_->first_visit(*other_row)});
  if (last - first < away_ && order.session_of_number(first) == order.session_of_number(last)) {
    return;
  }
  // The ring that went by the later number goes by the earlier one, and becomes a part of its ring.
  rename(last, first);
  std::swap(next_[order.slot(*row)], next_[order.slot(*other_row)]);
}

void SamePlaces::rename(std::uint64_t place, std::uint64_t first) noexcept {
  std::uint64_t at = place;
  do {
    const std::size_t row = *map_->order().row_of_number(at);
    map_->set_first_visit(row, first);
    at = next_[map_->order().slot(row)];
  } while (at != place);
}

void SamePlaces::join(std::uint64_t place, std::uint64_t other, Told& told) noexcept {
  const PlaceOrder& order = map_->order();
  join(place, other);
  const Told before = std::exchange(told, {place, other});
  const std::uint64_t places = place - before.place;
  if (place <= before.place || places > PlaceMap::most_between || other < before.other ||
      other - before.other > 2 * places ||
      order.session_of_number(before.other) != order.session_of_number(other)) {
    return;
  }
  for (std::uint64_t i = 1; i < places; ++i) {
    join(before.place + i, before.other + (other - before.other) * i / places);
  }
}

}  // namespace seqloop::program
