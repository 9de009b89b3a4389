// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "seqloop/detector.hpp"
#include "seqloop/matcher_config.hpp"
#include "seqloop/place_map.hpp"
#include "synthetic/places.hpp"

namespace seqloop::program {

/// A detector that localises a robot in a map of synthetic places, to be timed: the robot moves, is
/// recognised, and now and then is carried elsewhere.
class DrivenDetector {
 public:
  [[nodiscard]] static std::uint64_t bytes_needed(const MatcherConfig& config,
                                                  const Capacity& capacity);

  /// Makes the map, and drives until the window is full.
  /// Work: the map, place by place, in the memory that it stays in.
  DrivenDetector(const MatcherConfig& config, const Capacity& capacity);

  /// Drives to where the next frame is, and describes what is there.
  void drive();
  /// Takes that frame. Allocates: never.
  void step() noexcept;

  /// Of descriptors and sketches, that a step has read on average.
  [[nodiscard]] std::uint64_t bytes_a_step() const noexcept;
  /// Of the frames, the share whose accepted answer is a place within five of where they were.
  [[nodiscard]] double found() const noexcept;

 private:
  std::size_t stored_bytes_;
  SyntheticPlaces places_;
  SyntheticRobot robot_;
  PlaceMap map_;
  Detector detector_;
  std::vector<float> descriptor_;
  std::vector<double> positions_;  // by frame
  std::uint64_t steps_ = 0;        // with a full window; what they did:
  std::uint64_t distances_ = 0;
  std::uint64_t scanned_ = 0;
  std::uint64_t sketches_ = 0;
  std::size_t answered_ = 0;
  std::size_t found_ = 0;
};

}  // namespace seqloop::program
