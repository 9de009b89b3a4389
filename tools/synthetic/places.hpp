// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <random>
#include <span>
#include <vector>

namespace seqloop::program {

/// Descriptors of a street that nobody drove, of any length without keeping it: a smooth walk
/// through random directions, in which neighbours look alike. Every ten places it comes by a
/// direction that follows from its number alone, so that a map of a million places and drives
/// through it need no memory.
class SyntheticPlaces {
 public:
  /// @param size values in a descriptor, D
  explicit SyntheticPlaces(std::size_t size);

  /// What is seen at a place, or between two.
  /// @param position in places from the first one
  /// @param noise    to be added, as long as this times the place; never the same twice
  /// @param out      [D] of length 1
  /// Work: about 3 D. Allocates: never.
  void see(double position, float noise, std::span<float> out);

 private:
  struct Direction {
    std::uint64_t number;
    std::vector<float> values;
  };
  [[nodiscard]] std::span<const float> direction(std::uint64_t number);

  std::array<Direction, 2> directions_;
  std::vector<float> noise_;
  std::uint64_t seen_ = 0;
};

/// A robot that drives through a street, a little faster or slower than the map was made, and every
/// 500 frames is carried elsewhere.
class SyntheticRobot {
 public:
  explicit SyntheticRobot(std::size_t places) : places_(places) {}

  /// @return where the next frame is, in places from the first one
  double next();

 private:
  std::size_t places_;
  std::mt19937 random_{2};
  std::uint64_t frames_ = 0;
  double position_ = 0.0;
  double velocity_ = 1.0;
};

}  // namespace seqloop::program
