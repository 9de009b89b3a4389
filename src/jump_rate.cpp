// SPDX-License-Identifier: MIT
#include "seqloop/detail/jump_rate.hpp"

#include <algorithm>

namespace seqloop {
namespace {

constexpr std::size_t off = 20;  // rows that either may be off, and a little more

/// Whether a drive leads from one row to another of the same session by so many rows, or fewer.
bool goes_on(const PlaceOrder& order, std::size_t from, std::size_t to, std::size_t most) {
  const CandidateRun session = order.around(from);
  return to >= session.first && to < session.last && to + off >= from && to <= from + most + off;
}

/// The row of the first visit of a place, if that is there still.
std::size_t first_row(const PlaceMap& map, std::size_t row) {
  return map.order().row_of_number(map.first_visit(row)).value_or(row);
}

/// Whether two rows are visits of one place, as far as that is known: links may be off, too.
bool are_visits(const PlaceMap& map, std::size_t a, std::size_t b) {
  return map.same_place(a, b) || map.order().apart(first_row(map, a), first_row(map, b)) <= off;
}

/// Whether a drive may lead from one row to another in so many frames: by 0 to 2 rows a frame, as
/// the belief moves; through other visits of the same places; or, by a row a frame, beyond the end
/// of a session and in at the beginning of one, as laps do where the map is one of them.
bool leads_on(const PlaceMap& map, std::size_t from, std::size_t to, std::uint64_t frames) {
  constexpr std::uint64_t long_ago = 120;  // frames after which it may have come by another way
  if (frames > long_ago) return true;
  const PlaceOrder& order = map.order();
  const auto by = static_cast<std::size_t>(frames);
  if (goes_on(order, from, to, 2 * by)) return true;
  const CandidateRun before = order.around(from);
  const CandidateRun after = order.around(to);
  const std::size_t around_the_end = (before.last - 1 - from) + (to - after.first);
  if (around_the_end <= by + off) return true;
  return goes_on(order, first_row(map, from), first_row(map, to), 2 * by) ||
         are_visits(map, from, to) || are_visits(map, std::min(from + by, before.last - 1), to) ||
         are_visits(map, from, std::max(to - std::min(to, by), after.first));
}

}  // namespace

void JumpRate::take(const PlaceMap& map, std::uint64_t frame, std::size_t row,
                    std::uint64_t known_from) noexcept {
  if (row >= map.size() || (last_ && frame <= last_->frame)) return;
  const bool known = last_ && last_->frame >= known_from;
  if (known && !leads_on(map, last_->row, row, frame - last_->frame)) ++jumps_;
  last_ = {frame, row};
  ++answers_;
}

double JumpRate::chance() const noexcept {
  constexpr double without = 300.0;  // answers without a jump that every drive is credited with
  constexpr double more = 14.0;
  const double rate = static_cast<double>(jumps_) / (without + static_cast<double>(answers_));
  return std::min(0.5, more * rate);
}

}  // namespace seqloop
