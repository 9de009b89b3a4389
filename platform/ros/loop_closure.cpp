// SPDX-License-Identifier: MIT
#include "seqloop/ros/loop_closure.hpp"

#include "ros/cdr.hpp"
#include "ros/loop_closure_msg.hpp"

namespace seqloop::ros {
namespace {

/// The types that a loop closure is made of, as ROS 2 defines them.
constexpr std::string_view parts = R"(
================================================================================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id

================================================================================
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec

================================================================================
MSG: geometry_msgs/PoseWithCovariance
geometry_msgs/Pose pose
float64[36] covariance

================================================================================
MSG: geometry_msgs/Pose
geometry_msgs/Point position
geometry_msgs/Quaternion orientation

================================================================================
MSG: geometry_msgs/Point
float64 x
float64 y
float64 z

================================================================================
MSG: geometry_msgs/Quaternion
float64 x 0
float64 y 0
float64 z 0
float64 w 1
)";

}  // namespace

std::vector<std::uint8_t> message_of(const LoopClosure& closure) {
  CdrWriter cdr;
  cdr.time(closure.stamp_ns);
  cdr.text("");  // frame_id
  cdr.time(closure.match_stamp_ns);
  cdr.number(closure.frame);
  cdr.number(closure.match);
  cdr.text(closure.session);
  cdr.text(closure.robot);
  cdr.number(closure.probability);
  cdr.number(closure.uniqueness);
  cdr.number(closure.score);
  cdr.number(closure.velocity);
  cdr.number(std::uint32_t{0});  // no relative pose
  return cdr.bytes();
}

std::string loop_closure_definition() { return std::string(loop_closure_msg) + std::string(parts); }

}  // namespace seqloop::ros
