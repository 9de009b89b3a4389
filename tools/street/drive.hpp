// SPDX-License-Identifier: MIT
// A drive: legs, conditions and speed give one shot a frame.
#pragma once

#include <vector>

#include "scene.hpp"

namespace seqloop::street {

/// What makes one drive. Aggregate with usable defaults.
struct DrivePlan {
  std::vector<Leg> legs;
  std::size_t frames = 300;
  std::uint64_t seed = 1;  ///< of speed, sway, traffic and sensor noise, not of the street
  Light first, last;       ///< the light drifts from one to the other, and back on long drives
  double lateral = -1.9;   ///< metres left of the centre line, about which the camera wanders
  double wander = 0.25;    ///< metres
};

class Drive {
 public:
  /// @param plan at least one leg and one frame.
  Drive(Street street, DrivePlan plan);

  const Path& path() const noexcept { return path_; }
  std::size_t frames() const noexcept { return at_.size(); }
  /// @param frame below frames(). @return path metre, never less than the frame's before.
  double position(std::size_t frame) const noexcept { return at_[frame]; }
  std::size_t leg(std::size_t frame) const noexcept { return path_.leg_at(at_[frame]); }
  /// @return metre of the street where the frame was taken.
  double street(std::size_t frame) const noexcept;
  /// The camera and the light of a frame. Work: constant.
  Shot shot(std::size_t frame) const;

 private:
  DrivePlan plan_;
  Path path_;
  std::vector<double> at_;  ///< path metre of each frame
};

}  // namespace seqloop::street
