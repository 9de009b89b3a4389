// SPDX-License-Identifier: MIT
#include "camera.hpp"

#include <cmath>

namespace seqloop::street {

Camera make_camera(Vec3 eye, double yaw, double pitch, double roll, int width, int height) {
  const Vec3 ahead{std::cos(yaw) * std::cos(pitch), std::sin(yaw) * std::cos(pitch),
                   std::sin(pitch)};
  const Vec3 level_right{std::sin(yaw), -std::cos(yaw), 0.0};
  const Vec3 level_down = cross(ahead, level_right);
  Camera c;
  c.eye = eye;
  c.forward = ahead;
  c.right = level_right * std::cos(roll) + level_down * std::sin(roll);
  c.down = level_down * std::cos(roll) - level_right * std::sin(roll);
  c.width = width;
  c.height = height;
  c.cx = 0.5 * width;
  c.cy = 0.56 * height;
  c.focal = 0.5 * width / std::tan(41.0 * kPi / 180.0);
  return c;
}

}  // namespace seqloop::street
