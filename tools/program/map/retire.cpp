// SPDX-License-Identifier: MIT
#include "program/map/retire.hpp"

#include <algorithm>
#include <exception>
#include <unordered_map>

#include "program/map/superseded.hpp"

namespace seqloop::program {
namespace {

// A visit is kept for this many frames: fewer would let the file grow with the time driven.
constexpr std::uint64_t frames_a_visit = 16;

// A session of twice as many places or more is looked at in parts: a drive of many laps shrinks,
// too. Shorter ones would hold few lines.
constexpr std::size_t stretch_places = 300;

/// Places that go or stay together: of one session, in order.
struct Stretch {
  std::size_t session;
  std::vector<Sighting> places;
};

std::vector<Stretch> stretches(const StoredMap& stored, const PlaceMap& map,
                               std::span<const std::uint64_t> linked, std::uint64_t none) {
  std::unordered_map<std::uint64_t, double> sure;  // by place
  stored.file().read_links([&sure](const sqlite::SavedLink& link) {
    if (link.place) sure[*link.place] = link.probability;
  });
  const PlaceOrder& order = map.order();
  std::vector<Stretch> all;
  for (std::size_t session = 0; session < order.sessions(); ++session) {
    const CandidateRun rows = order.session(session);
    const std::size_t size = rows.last - rows.first;
    const std::size_t parts = std::max<std::size_t>(1, size / stretch_places);
    for (std::size_t part = 0; part < parts; ++part) {
      Stretch& stretch = all.emplace_back(Stretch{session, {}});
      const auto border = [&](std::size_t at) { return rows.first + size * at / parts; };
      for (std::size_t row = border(part); row < border(part + 1); ++row) {
        const std::uint64_t other = linked[order.slot(row)];
        Sighting place{order.number(row), other != none ? other : map.first_visit(row)};
        if (const auto found = sure.find(place.place); found != sure.end()) {
          place.probability = found->second;
        }
        stretch.places.push_back(place);
      }
    }
  }
  return all;
}

}  // namespace

std::vector<Retired> retire_superseded(StoredMap& stored, const PlaceMap& map,
                                       std::span<const std::uint64_t> linked, std::uint64_t none) {
  std::vector<Retired> retired;
  try {
    const std::vector<Stretch> all = stretches(stored, map, linked, none);
    std::vector<std::vector<Sighting>> places;
    places.reserve(all.size());
    for (const Stretch& stretch : all) places.push_back(stretch.places);
    const std::vector<std::size_t> gone = superseded(places);
    std::vector<Sighting> stays;
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (std::ranges::binary_search(gone, i)) continue;
      stays.insert(stays.end(), places[i].begin(), places[i].end());
    }
    for (const std::size_t i : gone) {
      const std::string& name = stored.name(all[i].session);
      const std::size_t visits =
          stored.file().retire(name, places[i].front().place, places[i].back().place,
                               successors(places[i], stays), frames_a_visit);
      if (retired.empty() || retired.back().session != name) retired.push_back({name});
      retired.back().places += places[i].size();
      retired.back().visits += visits;
    }
  } catch (const std::exception&) {  // after the next drive
  }
  return retired;
}

}  // namespace seqloop::program
