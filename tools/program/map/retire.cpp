// SPDX-License-Identifier: MIT
#include "program/map/retire.hpp"

#include <algorithm>
#include <exception>
#include <unordered_map>

#include "program/map/superseded.hpp"

namespace seqloop::program {
namespace {

// A visit is kept for so many frames: fewer would let the file grow with the time driven.
constexpr std::uint64_t frames_a_visit = 16;

/// Places of each session, in order.
std::vector<std::vector<Sighting>> sightings(const StoredMap& stored, const PlaceMap& map,
                                             std::span<const std::uint64_t> linked,
                                             std::uint64_t none) {
  std::unordered_map<std::uint64_t, double> sure;  // by place
  stored.file().read_links([&sure](const sqlite::SavedLink& link) {
    if (link.place) sure[*link.place] = link.probability;
  });
  const PlaceOrder& order = map.order();
  std::vector<std::vector<Sighting>> all(order.sessions());
  for (std::size_t row = 0; row < order.size(); ++row) {
    const std::uint64_t other = linked[order.slot(row)];
    Sighting place{order.number(row), other != none ? other : map.first_visit(row)};
    if (const auto found = sure.find(place.place); found != sure.end()) {
      place.probability = found->second;
    }
    all[order.session_of(row)].push_back(place);
  }
  return all;
}

}  // namespace

Retired retire_superseded(StoredMap& stored, const PlaceMap& map,
                          std::span<const std::uint64_t> linked, std::uint64_t none) {
  Retired retired;
  try {
    const std::vector<std::vector<Sighting>> sessions = sightings(stored, map, linked, none);
    const std::vector<std::size_t> gone = superseded(sessions);
    std::vector<Sighting> stays;
    for (std::size_t session = 0; session < sessions.size(); ++session) {
      if (std::ranges::binary_search(gone, session)) continue;
      stays.insert(stays.end(), sessions[session].begin(), sessions[session].end());
    }
    for (const std::size_t session : gone) {
      retired.visits += stored.file().retire(stored.name(session),
                                             successors(sessions[session], stays), frames_a_visit);
      retired.sessions.push_back(stored.name(session));
      retired.places += sessions[session].size();
    }
  } catch (const std::exception&) {  // after the next drive
  }
  return retired;
}

}  // namespace seqloop::program
