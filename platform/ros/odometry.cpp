// SPDX-License-Identifier: MIT
#include "seqloop/ros/odometry.hpp"

#include "ros/cdr.hpp"

namespace seqloop::ros {

std::optional<OdometryPose> read_odometry(std::span<const std::uint8_t> message) noexcept {
  CdrReader cdr(message);
  OdometryPose pose;
  pose.stamp_ns = cdr.stamp();
  static_cast<void>(cdr.text());  // child_frame_id
  for (double& value : pose.position) value = cdr.number<double>();
  for (double& value : pose.orientation) value = cdr.number<double>();
  if (!cdr.fault().empty()) return std::nullopt;
  return pose;
}

}  // namespace seqloop::ros
