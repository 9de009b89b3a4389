// SPDX-License-Identifier: MIT
#include "seqloop/place_map.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "seqloop/detail/stop_run.hpp"
#include "seqloop/difference.hpp"

namespace seqloop {
namespace {

// Rows among which the one that is missed least goes, each time a full map thins out.
constexpr std::size_t thinned_among = 64;

/// Whether descriptors come as they are, and are standardised here: to a map that is filled by the
/// drive alone they come standardised.
bool learns(const MatcherConfig& config, const Capacity& capacity) {
  return config.standardisation.on && (config.use == Use::localise || capacity.sessions > 1);
}

}  // namespace

std::vector<BufferSize> PlaceMap::plan(const MatcherConfig& config, const Capacity& capacity) {
  check(config, capacity);
  std::vector<BufferSize> buffers;
  const PlaceMap measured(Arena(buffers), config, capacity, ArenaMemory());
  return buffers;
}

PlaceMap::PlaceMap(const MatcherConfig& config, const Capacity& capacity,
                   std::span<std::byte> memory, bool zeroed)
    : PlaceMap(config, capacity, ArenaMemory(bytes_needed(config, capacity), memory),
               zeroed && !memory.empty()) {}

PlaceMap::PlaceMap(const MatcherConfig& config, const Capacity& capacity, ArenaMemory&& memory,
                   bool zeroed)
    : PlaceMap(Arena(memory.span(), zeroed), config, capacity, std::move(memory)) {}

PlaceMap::PlaceMap(Arena arena, const MatcherConfig& config, const Capacity& capacity,
                   ArenaMemory&& memory)
    : memory_(std::move(memory)),
      standardisation_(config.standardisation),
      full_map_(config.full_map),
      statistics_(arena, capacity.descriptor_size),
      added_(arena, learns(config, capacity) ? capacity.descriptor_size : 0,
             {"mean of what is added", "variance of what is added", "deviation of what is added",
              "last place that moved them"}),
      has_keyframes_(has_keyframes(config)),
      keyframes_(arena, learns(config, capacity) && has_keyframes_ ? capacity.descriptor_size : 0),
      order_(arena, capacity.places, capacity.sessions),
      rows_(arena, {"places", "lengths of places", "sketches of places"},
            DescriptorForm(config, capacity.descriptor_size), capacity.places),
      standardised_(arena.take<float>("a standardised place",
                                      learns(config, capacity) ? capacity.descriptor_size : 0)),
      side_by_side_(arena.take<std::uint8_t>("sketches of saved places, while they are made",
                                             DescriptorRows::sketch_room(rows_.form()))),
      spacing_(
          arena.take<float>("spacing of places", full_map_ == FullMap::thin ? capacity.places : 0)),
      thinned_(arena.take<std::uint8_t>("places behind thinned ones",
                                        full_map_ == FullMap::thin ? capacity.places : 0)),
      first_visits_(arena.take<std::uint64_t>(
          "visits of one place", config.decision == Decision::probability ? capacity.places : 0)),
      stood_(arena.take<std::uint32_t>(
          "stops at places", has_keyframes_ && capacity.sessions == 1 ? capacity.places : 0)) {}

bool PlaceMap::begin_session() noexcept {
  if (!order_.begin_session()) return false;
  learning_ = false;
  return true;
}

bool PlaceMap::fits(std::span<const float> descriptor) const noexcept {
  return descriptor.size() == descriptor_size() && all_finite(descriptor);
}

bool PlaceMap::learn(std::span<const float> descriptor) noexcept {
  const CandidateRun newest = order_.newest_session();
  if (standardised_.empty() || newest.first != newest.last || !fits(descriptor)) return false;
  if (!std::exchange(learning_, true)) statistics_.forget();
  statistics_.observe(descriptor);
  return true;
}

bool PlaceMap::add(std::span<const float> descriptor) noexcept {
  if (size() == capacity() || !fits(descriptor)) return false;
  const std::size_t first = order_.newest_session().first;
  std::uint64_t frame = first == size() ? 0 : order_.frame(size() - 1) + 1;
  if (!standardised_.empty()) {
    if (first == size()) {
      added_.start_from(statistics_, standardisation_.prior_frames);
      keyframes_.begin();
      no_places_ = 0;
    }
    added_.follow(descriptor, standardisation_);
    if (has_keyframes_ && !keyframes_.take(descriptor, added_.variance_sum()) && first != size()) {
      ++no_places_;
      if (!keyframes_.is_dense()) stand(1);
      return true;
    }
    order_.count_from(order_.next_number() + no_places_);
    frame += std::exchange(no_places_, 0);
    added_.standardise(descriptor, standardised_);
    descriptor = standardised_;
  } else {
    holds_raw_ = true;
  }
  rows_.store(append(frame, order_.next_number()), descriptor);
  space(size() - 1);
  return true;
}

std::size_t PlaceMap::add_saved(std::span<const Saved> places) noexcept {
  std::array<std::size_t, sketched_together> slots;
  std::size_t unsketched = 0;
  std::size_t added = 0;
  for (const Saved& place : places) {
    slots[unsketched] = order_.next_slot();
    if (!insert_unsketched(order_.sessions() - 1, place)) break;
    ++added;
    if (++unsketched == slots.size()) {
      rows_.sketch(slots, side_by_side_);
      unsketched = 0;
    }
  }
  rows_.sketch(std::span(slots).first(unsketched), side_by_side_);
  return added;
}

std::optional<std::size_t> PlaceMap::add_saved_to(std::size_t session,
                                                  const Saved& place) noexcept {
  const std::array<std::size_t, 1> slot{order_.next_slot()};
  const std::optional<std::size_t> row = insert_unsketched(session, place);
  if (row) rows_.sketch(slot, side_by_side_);
  return row;
}

/// Puts a place behind the last of a session. @return its row
std::optional<std::size_t> PlaceMap::insert_unsketched(std::size_t session,
                                                       const Saved& place) noexcept {
  if (session >= order_.sessions()) return std::nullopt;
  const auto [first, last] = order_.session(session);
  const bool follows = std::max(place.number, place.frame) < number_end &&
                       order_.may_give(session, place.number) &&
                       (first == last || place.frame > order_.frame(last - 1)) &&
                       (session + 1 == order_.sessions() || full_map_ != FullMap::refuse);
  const std::size_t slot = order_.next_slot();
  if (size() == capacity() || !follows || !rows_.load(slot, place.descriptor)) return std::nullopt;
  order_.insert(session, place.frame, place.number);
  if (!first_visits_.empty()) first_visits_[slot] = place.number;
  if (!stood_.empty()) stood_[slot] = 0;
  if (!thinned_.empty()) {
    const bool follows_at_once = first == last || place.number == order_.number(last - 1) + 1;
    thinned_[slot] = follows_at_once ? 0 : 1;
  }
  if (last_linked_ >= last && last + 1 < size()) ++*last_linked_;
  space(last);
  return last;
}

bool PlaceMap::set_statistics(std::span<const double> mean, std::span<const double> variance,
                              std::uint64_t frames) noexcept {
  if (!standardisation_.on || frames == 0) return false;
  return statistics_.restore(mean, variance, frames);
}

/// Makes the newest row. @return its slot
std::size_t PlaceMap::append(std::uint64_t frame, std::uint64_t number) noexcept {
  const std::size_t slot = order_.append(frame, number);
  if (!first_visits_.empty()) first_visits_[slot] = number;
  if (!stood_.empty()) stood_[slot] = 0;
  if (!thinned_.empty()) thinned_[slot] = 0;
  return slot;
}

/// Notes how far a row is from the one before it.
void PlaceMap::space(std::size_t row) noexcept {
  if (full_map_ != FullMap::thin) return;
  const std::size_t slot = order_.slot(row);
  const bool begins = row == order_.around(row).first;
  spacing_[slot] = begins ? std::numeric_limits<float>::infinity()
                          : static_cast<float>(rows_.between(slot, order_.slot(row - 1)));
}

bool PlaceMap::has_all(std::size_t first, std::size_t last) const noexcept {
  if (thinned_.empty()) return true;
  for (std::size_t row = first + 1; row <= std::min(last, size() - 1); ++row) {
    if (thinned_[order_.slot(row)] != 0) return false;
  }
  return true;
}

void PlaceMap::link(std::size_t row, std::size_t earlier) noexcept {
  if (first_visits_.empty()) return;
  const auto first_visit = [&](std::size_t r) -> std::uint64_t& {
    return first_visits_[order_.slot(r)];
  };
  first_visit(row) = first_visit(earlier);
  const std::size_t from = std::exchange(last_linked_, row).value_or(row);
  if (from >= row || order_.apart(from, row) > most_between) return;
  const std::optional<std::size_t> first = order_.row_of_number(first_visit(from));
  const std::optional<std::size_t> last = order_.row_of_number(first_visit(row));
  const std::size_t rows = row - from;
  if (!first || !last || *last < *first || order_.apart(*first, *last) > 2 * rows) return;
  for (std::size_t i = 1; i < rows; ++i) {
    first_visit(from + i) = order_.number(*first + (*last - *first) * i / rows);
  }
}

std::optional<CandidateRun> PlaceMap::stop_at(std::size_t row) const noexcept {
  if (stood_.empty() || row >= size()) return std::nullopt;
  const CandidateRun session = order_.around(row);
  const std::uint64_t begin = row - std::min<std::uint64_t>(row, StopRun::reach);
  const auto run =
      StopRun::around(row, std::max<std::uint64_t>(session.first, begin),
                      std::min<std::uint64_t>(session.last, row + StopRun::reach + 1),
                      [this](std::uint64_t one) { return stood(static_cast<std::size_t>(one)); });
  if (!run) return std::nullopt;
  return CandidateRun{static_cast<std::size_t>(run->first),
                      static_cast<std::size_t>(run->last) + 1};
}

PlaceMap::Taken PlaceMap::take(const DescriptorRows& queries, std::size_t query,
                               std::uint64_t frame, std::size_t keep) noexcept {
  Taken taken;
  if (size() == capacity()) {
    taken.removed = row_to_go(keep);
    if (!taken.removed) return taken;
    taken.forgotten =
        *taken.removed == 0 || *taken.removed + 1 == order_.around(*taken.removed).last;
    order_.remove(*taken.removed);
    if (last_linked_ == taken.removed) {
      last_linked_.reset();
    } else if (last_linked_ > taken.removed) {
      --*last_linked_;
    }
    // The row behind the gap has another one before it now.
    if (*taken.removed < size()) {
      space(*taken.removed);
      if (!thinned_.empty()) thinned_[order_.slot(*taken.removed)] = 1;
    }
  }
  const std::size_t slot = append(frame, order_.next_number());
  rows_.copy(slot, queries, query);
  space(size() - 1);
  taken.slot = slot;
  return taken;
}

std::optional<std::size_t> PlaceMap::row_to_go(std::size_t keep) noexcept {
  if (full_map_ == FullMap::refuse || size() <= keep) return std::nullopt;
  if (full_map_ == FullMap::forget_oldest || size() == 1) return 0;
  // The first and the last row of what may go have no two neighbours. Nor have those of a session:
  // one of them goes only where there is no other.
  const std::size_t last = size() - std::max<std::size_t>(keep, 1);
  if (hand_ + 1 >= last) hand_ = 0;
  const auto missed = [&](std::size_t row) {
    return spacing_[order_.slot(row)] + spacing_[order_.slot(row + 1)];
  };
  const auto least_from = [&](std::size_t hand) {
    const std::size_t end = std::min(hand + thinned_among, last - 1);
    std::size_t least = std::min(hand + 1, last - 1);
    for (std::size_t row = least; row <= end; ++row) {
      if (missed(row) < missed(least)) least = row;
    }
    hand_ = end;
    return least;
  };
  const std::size_t least = least_from(hand_);
  // The last rows of a round may be few, and ends of sessions all of them.
  if (std::isinf(missed(least)) && hand_ + 1 >= last) return least_from(0);
  return least;
}

}  // namespace seqloop
