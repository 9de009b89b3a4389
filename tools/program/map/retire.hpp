// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "program/map/stored_map.hpp"
#include "seqloop/place_map.hpp"

namespace seqloop::program {

/// Places that went from a map.
struct Retired {
  std::string session;
  std::size_t places = 0;
  std::size_t visits = 0;  ///< that are left of them
};

/// Lets places go from the file of which enough was seen since, session by session, and of long
/// ones stretch by stretch; their frames stay as visits. What cannot be written stays for now, and
/// goes after the next drive.
/// @param map all that the file holds
/// @param linked [capacity] by slot: the place that this one is a visit of; `none`: the map knows
/// @return a row for each session that has lost any
[[nodiscard]] std::vector<Retired> retire_superseded(StoredMap& stored, const PlaceMap& map,
                                                     std::span<const std::uint64_t> linked,
                                                     std::uint64_t none);

}  // namespace seqloop::program
