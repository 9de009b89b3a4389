// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>

#include "program/fleet/fleet_settings.hpp"
#include "program/map/lasting_map.hpp"
#include "program/run/other_loop.hpp"
#include "seqloop/detector.hpp"
#include "seqloop/pipeline.hpp"

namespace seqloop::dds {
class Participant;
}

namespace seqloop::program {

/// A robot among others: tells them its places, and finds loops with theirs.
///
/// What others tell is heard by a thread of its own, and comes into a map of its own, in which each
/// of their sessions is one: the drive is localised in it. Its own sessions and those of others do
/// not compete; a frame may close a loop with both.
class Fleet {
 public:
  /// @param participant, map live longer; the map has not begun yet
  /// @param config of the run's detector   @param own the run's places, as they are loaded
  /// Throws SetupError; std::bad_alloc.
  Fleet(const FleetSettings& settings, std::shared_ptr<dds::Participant> participant,
        LastingMap& map, const MatcherConfig& config, const PlaceMap& own);
  Fleet(const Fleet&) = delete;
  Fleet& operator=(const Fleet&) = delete;
  Fleet(Fleet&&) = delete;
  Fleet& operator=(Fleet&&) = delete;
  ~Fleet();

  /// Takes in some of what others have told meanwhile, and compares the frame with all of it.
  /// @param processed before its frames are named as its source does; what this takes is added to
  ///   its times
  /// Work: 64 places at most, and a step. Allocates: never. No system call but the clock's.
  void step(ProcessedFrame& processed, Clock& clock) noexcept;

  /// The drive is over. The answers that still wait are the next that `add_to` adds.
  /// @param rest the last answers of the run's detector, as it counts
  void finish(std::span<const Answer> rest) noexcept;

  /// Loops of the newest step, or of `finish`.
  [[nodiscard]] std::span<const OtherLoop> loops() const noexcept;

  /// Places of others that are known.
  [[nodiscard]] std::size_t places() const noexcept;

  /// Adds the answers of the newest step: `fleet`, an array; and `fleet_places`, how many places of
  /// others are known.
  void add_to(nlohmann::ordered_json& frame) const;

  /// What there is to say of others, a line at a time. Never waits.
  [[nodiscard]] std::optional<std::string> trouble();

  /// Others get what was told last, if they take it within a second.
  /// @return what was told and heard, for a summary
  [[nodiscard]] std::string end();

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace seqloop::program
