// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "evaluation/csv.hpp"

namespace seqloop::evaluation {

/// Where the frames of a drive were.
struct Positions {
  struct Place {
    std::uint64_t frame;
    /// Metres, the last one northwards: 0, x, y on a plan; or from the middle of the earth, taken
    /// as a ball, so that a straight line between two places says how long the way over the ground
    /// is.
    std::array<double, 3> point;
  };

  std::vector<Place> places;  ///< one a frame; frames whose place nobody knows are missing
  bool on_earth = false;

  /// Columns `frame,x,y` in metres, or `frame,latitude,longitude` in degrees.
  /// Throws SetupError as CsvTable does; neither or both of the two kinds; no rows; a frame given
  /// twice; numbers that are no place.
  static Positions from_csv(const CsvTable& table);
};

/// A straight line that ends where a way over the ground of this length ends, both in metres.
[[nodiscard]] double chord(double way_m) noexcept;

}  // namespace seqloop::evaluation
