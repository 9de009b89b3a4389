// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "seqloop/place_map.hpp"

namespace seqloop::program {

/// Places of several sessions that are one, whoever has told it and in whatever order: all that
/// hang together go by the number of one of them, so that none competes with another.
///
/// Places that a robot passed soon after each other are never made one, even if a third is linked
/// to both: links are off by a few frames, and step by step all of a road would become one place.
class SamePlaces {
 public:
  /// @param map its places' numbers rise with their frames; only this object links them, and none
  /// of
  ///   them goes. It lives longer.
  /// @param away frames that a robot is away before it is back at a place
  SamePlaces(PlaceMap& map, std::uint64_t away);

  /// A place has come into the map.
  void added(std::size_t row) noexcept;

  /// Two places are one. Work: log N for each that hangs together with them. Allocates: never.
  void join(std::uint64_t one, std::uint64_t other) noexcept;

  /// Places of one session, told one after another, are places of another one. Those between two
  /// successive ones are, too, if both lie close together.
  /// @param told what was joined last of the session; changed. Work: 40 `join`s at most
  struct Told {
    std::uint64_t place = 0;
    std::uint64_t other = 0;
  };
  void join(std::uint64_t place, std::uint64_t other, Told& told) noexcept;

 private:
  void rename(std::uint64_t place, std::uint64_t first) noexcept;

  PlaceMap* map_;
  std::uint64_t away_;
  std::vector<std::uint64_t>
      next_;  // by slot: number of the next one of those that are one, a ring
};

}  // namespace seqloop::program
