// SPDX-License-Identifier: MIT
#include "program/map/superseded.hpp"

#include <algorithm>
#include <unordered_map>

namespace seqloop::program {
namespace {

// All chosen on garage_laps; the page of the room platform/sqlite has the numbers.
constexpr std::size_t enough_visits = 6;      // sessions
constexpr std::uint64_t side_by_side = 16;    // places that count as one
constexpr std::size_t longest_stretch = 15;   // places
constexpr std::size_t most_not_visited = 40;  // percent of a session's places

/// In which sessions places were seen, the newest session first.
using Visits = std::unordered_map<std::uint64_t, std::vector<std::size_t>>;

/// How many sessions have been where a place is.
std::size_t visits_of(const Visits& visits, std::uint64_t first) {
  const auto found = visits.find(first / side_by_side);
  return found == visits.end() ? 0 : found->second.size();
}

}  // namespace

std::vector<std::size_t> superseded(std::span<const std::vector<Sighting>> sessions) {
  std::vector<std::size_t> found;
  Visits visits;
  for (std::size_t session = sessions.size(); session-- > 0;) {
    const std::vector<Sighting>& places = sessions[session];
    std::size_t missing = 0;
    std::size_t stretch = 0;
    std::size_t longest = 0;
    for (const Sighting& place : places) {
      const bool enough = visits_of(visits, place.first) >= enough_visits;
      stretch = enough ? 0 : stretch + 1;
      longest = std::max(longest, stretch);
      if (!enough) ++missing;
    }
    const bool goes = !places.empty() && longest <= longest_stretch &&
                      missing * 100 <= places.size() * most_not_visited;
    if (goes) found.insert(found.begin(), session);
    for (const Sighting& place : places) {
      std::vector<std::size_t>& seen = visits[place.first / side_by_side];
      if (seen.empty() || seen.back() != session) seen.push_back(session);
    }
  }
  return found;
}

std::vector<sqlite::Successor> successors(std::span<const Sighting> goes,
                                          std::span<const Sighting> stays) {
  std::unordered_map<std::uint64_t, Sighting> newest;  // by the first place there
  for (const Sighting& place : stays) {
    Sighting& known = newest[place.first];
    if (known.place <= place.place) known = place;
  }
  std::vector<const Sighting*> own(goes.size());  // those of places that have one themselves
  for (std::size_t i = 0; i < goes.size(); ++i) {
    const auto next = newest.find(goes[i].first);
    if (next != newest.end()) own[i] = &next->second;
  }
  std::vector<sqlite::Successor> found;
  for (std::size_t i = 0; i < goes.size(); ++i) {
    for (std::size_t apart = 0; apart <= side_by_side; ++apart) {
      std::size_t at = i + apart;
      if (apart <= i && own[i - apart] != nullptr) at = i - apart;
      if (at >= goes.size() || own[at] == nullptr) continue;
      found.push_back(
          {goes[i].place, own[at]->place, std::min(goes[at].probability, own[at]->probability)});
      break;
    }
  }
  return found;
}

}  // namespace seqloop::program
