// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "program/map/stored_map.hpp"
#include "seqloop/place_map.hpp"

namespace seqloop::program {

/// What went from a map, and what is left of it.
struct Retired {
  std::vector<std::string> sessions;  ///< names
  std::size_t places = 0;
  std::size_t visits = 0;
};

/// Lets places of sessions go from the file of which later ones have seen enough; their frames stay
/// as visits. What cannot be written stays for now, and goes after the next drive.
/// @param map all that the file holds
/// @param linked [capacity] by slot: the place that this one is a visit of; `none`: the map knows
Retired retire_superseded(StoredMap& stored, const PlaceMap& map,
                          std::span<const std::uint64_t> linked, std::uint64_t none);

}  // namespace seqloop::program
