// SPDX-License-Identifier: MIT
// Pinhole camera and the flat surfaces it sees.
#pragma once

#include <cstdint>
#include <vector>

#include "math.hpp"

namespace seqloop::street {

/// Pinhole at `eye` in the layout frame; pixel (px, py) looks along
/// right * (px + 0.5 - cx) / focal + down * (py + 0.5 - cy) / focal + forward.
struct Camera {
  Vec3 eye, right, down, forward;
  double focal{}, cx{}, cy{};  ///< pixels
  int width{}, height{};       ///< pixels

  /// @return x right, y down, z ahead, metres.
  Vec3 to_camera(Vec3 p) const noexcept {
    const Vec3 q = p - eye;
    return {dot(q, right), dot(q, down), dot(q, forward)};
  }
};

/// @param yaw rad left, @param pitch rad up, @param roll rad clockwise. The horizontal field of
/// view is 82 degrees whatever the size.
Camera make_camera(Vec3 eye, double yaw, double pitch, double roll, int width, int height);

enum class Material : std::uint8_t { facade, roof, ground, car, fence, plain, glow };

/// A flat polygon with metric coordinates u, v on it, in camera coordinates.
struct Surface {
  static constexpr int kMaxCorners = 8;

  Material material{};
  std::uint32_t item{};  ///< index into the scene's list for this material
  Vec3 origin, along_u, along_v;
  Vec3 corners[kMaxCorners];
  int corner_count{};
  float sun{};                ///< share of the sun's light it takes by its slope, 0..1
  float shade_below = -1.0F;  ///< v below which houses opposite keep the sun off
  Color color;                ///< for plain and glow
};

}  // namespace seqloop::street
