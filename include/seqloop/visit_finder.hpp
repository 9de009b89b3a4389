// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <span>

#include "seqloop/detector.hpp"
#include "seqloop/matcher_config.hpp"
#include "seqloop/place_map.hpp"

namespace seqloop {

/// Finds which places of a drive are visits of one place, for a robot that is to localise in it: by
/// closing the drive's own loops. Without that all laps of a way but one count as wrong rows, which
/// are as good as the right one. Source: src/README.md, section 6.5.
class VisitFinder {
 public:
  /// Whether there is anything to find: places are known by probability, and the map is for
  /// localising.
  [[nodiscard]] static bool is_needed(const MatcherConfig& config) noexcept {
    return config.decision == Decision::probability && config.use == Use::localise;
  }

  /// Allocates: a map of its own for so many places, and a detector. @param config, map as a
  /// detector that localises is given them; the map may be empty still
  /// @param places of the drive; 1 or more
  /// Errors: SetupError.
  VisitFinder(const MatcherConfig& config, const PlaceMap& map, std::size_t places);

  /// Takes the next place of the drive, as the map takes it; one beyond `places` is passed over.
  /// Work: a step of a detector that closes loops. Allocates: never.
  void take(std::span<const float> descriptor) noexcept;

  /// Links the places of the map's newest session, which is that drive; once, at its end. None, if
  /// no answer was accepted: many drives never come back to where they were, and much looks alike.
  /// Work: the places times their logarithm. Allocates: never.
  void link(PlaceMap& map) noexcept;

 private:
  void note(std::span<const Answer> answers) noexcept;

  PlaceMap map_;
  Detector detector_;
  bool comes_back_ = false;
};

}  // namespace seqloop
