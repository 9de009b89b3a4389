// SPDX-License-Identifier: MIT
#include "seqloop/detail/jump_rate.hpp"

#include <algorithm>

namespace seqloop {
namespace {

/// Whether a drive may lead from one row to another in so many frames: by 0 to 2 rows a frame, as
/// the belief moves; through other visits of the same places; or, by a row a frame, beyond the end
/// of a session and in at the beginning of one, as laps do where the map is one of them.
bool leads_on(const PlaceMap& map, std::size_t from, std::size_t to, std::uint64_t frames) {
  constexpr std::uint64_t long_ago = 120;  // frames after which it may have come by another way
  constexpr std::size_t off = 20;          // rows that either may be off, and a little more
  if (frames > long_ago) return true;
  const CandidateRun before = map.order().around(from);
  const CandidateRun after = map.order().around(to);
  const auto by = static_cast<std::size_t>(frames);
  if (to >= before.first && to < before.last && to + off >= from && to <= from + 2 * by + off) {
    return true;
  }
  const std::size_t around_the_end = (before.last - 1 - from) + (to - after.first);
  if (around_the_end <= by + off) return true;
  return map.same_place(from, to) || map.same_place(std::min(from + by, before.last - 1), to) ||
         map.same_place(from, std::max(to - std::min(to, by), after.first));
}

}  // namespace

void JumpRate::take(const PlaceMap& map, std::uint64_t frame, std::size_t row,
                    std::uint64_t oldest) noexcept {
  if (row >= map.size() || (last_ && frame <= last_->frame)) return;
  const bool goes_on = last_ && last_->frame >= oldest && last_->row < map.size();
  if (goes_on && !leads_on(map, last_->row, row, frame - last_->frame)) ++jumps_;
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
