// SPDX-License-Identifier: MIT
#include "program/fleet/others_map.hpp"

namespace seqloop::program {
namespace {

/// Frames are standardised, and may be moved to the side, as those of the run are.
PlaceMap& started_as(const PlaceMap& own, PlaceMap& map) {
  map.set_columns(own.columns());
  const RunningStatistics& known = own.statistics();
  if (known.frames() == 0) return map;
  const std::vector<double> mean(known.mean().begin(), known.mean().end());
  const std::vector<double> variance(known.variance().begin(), known.variance().end());
  static_cast<void>(map.set_statistics(mean, variance, known.frames()));
  return map;
}

}  // namespace

// None of others' places goes; but they come in any order, and search has room for that only where
// some might.
MatcherConfig OthersMap::suited(MatcherConfig config) {
  config.use = Use::localise;
  config.full_map = FullMap::forget_oldest;
  return config;
}

std::vector<BufferSize> OthersMap::plan(const Capacity& capacity) {
  return {{"places that are one", capacity.places * sizeof(std::uint64_t)},
          {"sessions as they were heard",
           capacity.sessions * (2 * sizeof(std::uint32_t) + sizeof(SamePlaces::Told))}};
}

OthersMap::OthersMap(const MatcherConfig& config, std::size_t places, std::size_t sessions,
                     const PlaceMap& own)
    : map_(suited(config), {places, own.descriptor_size(), sessions}),
      detector_(suited(config), started_as(own, map_)),
      same_(map_, config.exclude),
      begun_(sessions, none),
      heard_of_(sessions, none),
      told_(sessions) {}

bool OthersMap::take_in(const Place& place, std::span<const std::byte> bytes) noexcept {
  if (place.frame >= frames_of_a_session) return false;
  std::uint32_t& session = begun_[place.session];
  const bool is_new = session == none;
  if (is_new) {
    map_.count_from(place_number(used_, 0));
    if (!map_.begin_session()) return false;
    session = used_;
  }
  const std::uint64_t its = number(place);
  if (!detector_.take_in(session, {its, place.frame, bytes})) {
    if (is_new) session = none;
    return false;
  }
  same_.added(map_.order().session(session).last - 1);
  if (is_new) heard_of_[used_++] = place.session;
  return true;
}

void OthersMap::same_place(const Place& one, const Place& other) noexcept {
  if (begun_[one.session] == none || begun_[other.session] == none) return;
  if (one.session == other.session) {
    same_.join(number(one), number(other));
  } else {
    same_.join(number(one), number(other), told_[one.session]);
  }
}

FrameReport OthersMap::step(std::span<const float> descriptor, std::uint64_t lost) noexcept {
  detector_.skip(lost);
  return detector_.step(descriptor);
}

OthersMap::Place OthersMap::where(std::uint64_t number) const noexcept {
  return {heard_of_[static_cast<std::size_t>(session_of(number))], frame_of(number)};
}

}  // namespace seqloop::program
