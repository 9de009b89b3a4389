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

/// Sessions that a map can do without, because what they saw was seen again often enough since:
/// .6 of their places in six later sessions or more, and no stretch of more than 60 was not.
/// Sessions go whole: lines run through the places of one session, and find little in its pieces.
/// @param sessions the oldest first, with their places in order
/// @return their indices, rising
[[nodiscard]] std::vector<std::size_t> superseded(std::span<const std::vector<Sighting>> sessions);

/// Which places stand for those of a session that goes: of those that stay the newest that was
/// first seen where they were; where there is none, that of a neighbour, up to 16 places away.
/// @param goes places of the session, in order
/// @param stays all places that stay, in any order
/// @return of those for which there is one, in order
[[nodiscard]] std::vector<sqlite::Successor> successors(std::span<const Sighting> goes,
                                                        std::span<const Sighting> stays);

}  // namespace seqloop::program
