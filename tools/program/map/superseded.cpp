// SPDX-License-Identifier: MIT
#include "program/map/superseded.hpp"

#include <algorithm>
#include <unordered_map>

namespace seqloop::program {
namespace {

// Chosen on garage_laps, the longest stretch on Nordland's side roads; the page of the room
// platform/sqlite has the numbers.
constexpr std::size_t enough_visits = 6;      // stretches
constexpr std::uint64_t side_by_side = 16;    // places from one that was seen to the next
constexpr std::size_t longest_stretch = 15;   // places
constexpr std::size_t most_not_visited = 40;  // percent of a session's places

/// What stretches have seen: first places, rising.
class Visits {
 public:
  void add(std::span<const Sighting> places) {
    const std::size_t stretch = seen_.size();
    std::vector<std::uint64_t>& seen = seen_.emplace_back();
    for (const Sighting& place : places) seen.push_back(place.first);
    std::ranges::sort(seen);
    for (const std::uint64_t first : seen) {
      std::vector<std::size_t>& here = near_[first / side_by_side];
      if (here.empty() || here.back() != stretch) here.push_back(stretch);
    }
  }

  /// How many have seen a place, or one before and one behind it that are side by side.
  [[nodiscard]] std::size_t of(std::uint64_t first) const {
    const std::uint64_t at = first / side_by_side;
    std::vector<std::size_t> stretches;
    for (const std::uint64_t near : {at == 0 ? at : at - 1, at, at + 1}) {
      const auto found = near_.find(near);
      if (found == near_.end()) continue;
      stretches.insert(stretches.end(), found->second.begin(), found->second.end());
    }
    std::ranges::sort(stretches);
    const auto end = std::unique(stretches.begin(), stretches.end());
    return static_cast<std::size_t>(std::count_if(
        stretches.begin(), end, [&](std::size_t i) { return has_seen(seen_[i], first); }));
  }

 private:
  static bool has_seen(const std::vector<std::uint64_t>& seen, std::uint64_t first) {
    const auto next = std::ranges::lower_bound(seen, first);
    if (next == seen.end()) return false;
    return *next == first || (next != seen.begin() && *next - *std::prev(next) <= side_by_side);
  }

  std::vector<std::vector<std::uint64_t>> seen_;
  std::unordered_map<std::uint64_t, std::vector<std::size_t>> near_;  // by sixteen
};

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
      const bool enough = visits.of(place.first) >= enough_visits;
      stretch = enough ? 0 : stretch + 1;
      longest = std::max(longest, stretch);
      if (!enough) ++missing;
    }
    const bool goes = !places.empty() && longest <= longest_stretch &&
                      missing * 100 <= places.size() * most_not_visited;
    if (goes) found.insert(found.begin(), session);
    visits.add(places);
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
