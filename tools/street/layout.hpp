// SPDX-License-Identifier: MIT
// The road around the camera, unrolled from headings into the plane.
#pragma once

#include <vector>

#include "math.hpp"
#include "route.hpp"

namespace seqloop::street {

/// Centre line near one camera position. Frame: origin on the centre line at path metre `p`, x
/// along its heading there, y left, z up.
class Layout {
 public:
  static constexpr double kBehind = 24.0;  ///< metres kept behind the camera
  static constexpr double kAhead = 210.0;  ///< metres kept ahead
  static constexpr double kStep = 2.0;     ///< metres between samples

  Layout(const Path& path, std::size_t leg, double p);

  const std::vector<Piece>& pieces() const noexcept { return pieces_; }
  /// Absolute heading of the x axis, rad.
  double heading() const noexcept { return heading_; }
  double begin() const noexcept { return begin_; }
  double end() const noexcept { return begin_ + kStep * static_cast<double>(samples_.size() - 1); }
  /// @param p path metre, clamped to begin()..end(). @param d metres left. @param z metres up.
  Vec3 place(double p, double d, double z = 0.0) const noexcept;
  /// Heading at p relative to the x axis, rad.
  double turn(double p) const noexcept;

 private:
  struct Sample {
    double x, y, turn;
  };
  Sample at(double p) const noexcept;

  std::vector<Piece> pieces_;
  std::vector<Sample> samples_;
  double begin_;
  double heading_;
};

}  // namespace seqloop::street
