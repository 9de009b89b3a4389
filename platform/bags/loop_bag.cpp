// SPDX-License-Identifier: MIT
#include "seqloop/bags/loop_bag.hpp"

#include <string>
#include <utility>

#include "bags/cdr.hpp"
#include "bags/loop_closure_msg.hpp"
#include "bags/mcap_writer.hpp"

namespace seqloop::bags {
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

void put_time(CdrWriter& cdr, std::int64_t time_ns) {
  constexpr std::int64_t second = 1'000'000'000;
  cdr.number(static_cast<std::int32_t>(time_ns / second));
  cdr.number(static_cast<std::uint32_t>(time_ns % second));
}

}  // namespace

class LoopBag::Impl {
 public:
  explicit Impl(Write write)
      : writer_(std::move(write), {"/seqloop/loop_closures", "seqloop_msgs/msg/LoopClosure",
                                   std::string(loop_closure_msg) + std::string(parts)}) {}

  McapWriter writer_;
};

LoopBag::LoopBag(Write write) : impl_(std::make_unique<Impl>(std::move(write))) {}

LoopBag::~LoopBag() = default;

void LoopBag::add(const LoopClosure& closure, std::int64_t known_ns) {
  CdrWriter cdr;
  put_time(cdr, closure.stamp_ns);
  cdr.text("");  // frame_id
  put_time(cdr, closure.match_stamp_ns);
  cdr.number(closure.frame);
  cdr.number(closure.match);
  cdr.text(closure.session);
  cdr.number(closure.probability);
  cdr.number(closure.uniqueness);
  cdr.number(closure.score);
  cdr.number(closure.velocity);
  cdr.number(std::uint32_t{0});  // no relative pose
  impl_->writer_.add(known_ns, cdr.bytes());
}

void LoopBag::finish() { impl_->writer_.finish(); }

}  // namespace seqloop::bags
