// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "seqloop/sqlite/map_file.hpp"

namespace seqloop::program {

/// A place, and what is known of where it is.
struct Sighting {
  std::uint64_t place = 0;   ///< number
  std::uint64_t first = 0;   ///< number of the first place that was there; its own, where it is new
  double probability = 1.0;  ///< that these two are one
};

/// Stretches that a map can do without, because what they saw was seen again often enough since: .6
/// of their places in six later stretches or more, and no more than 15 in a row were not. What lies
/// between two first places of a stretch, 16 apart at most, was seen in it. Stretches are
/// sessions, or long parts of sessions: lines run through the places of one, and find little in
/// short pieces.
/// @param stretches the oldest first, with their places in order
/// @return their indices, rising
[[nodiscard]] std::vector<std::size_t> superseded(std::span<const std::vector<Sighting>> stretches);

/// Which places stand for those of a session that goes: of those that stay the newest that was
/// first seen where they were; where there is none, that of a neighbour, up to 16 places away.
/// @param goes places of the session, in order
/// @param stays all places that stay, in any order
/// @return of those for which there is one, in order
[[nodiscard]] std::vector<sqlite::Successor> successors(std::span<const Sighting> goes,
                                                        std::span<const Sighting> stays);

}  // namespace seqloop::program
