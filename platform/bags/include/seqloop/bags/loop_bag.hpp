// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>

#include "seqloop/ros/loop_closure.hpp"

namespace seqloop::bags {

/// Writes loop closures as a bag of ROS 2, an MCAP file: topic `/seqloop/loop_closures`, type
/// `seqloop_msgs/msg/LoopClosure`.
class LoopBag {
 public:
  using Write = std::function<void(std::span<const std::uint8_t>)>;

  /// Begins the file. @param write takes its bytes, in order; what it throws passes through
  explicit LoopBag(Write write);
  LoopBag(const LoopBag&) = delete;
  LoopBag& operator=(const LoopBag&) = delete;
  LoopBag(LoopBag&&) = delete;
  LoopBag& operator=(LoopBag&&) = delete;
  ~LoopBag();

  /// @param known_ns when it became known, since 1970: its time in the bag
  void add(const ros::LoopClosure& closure, std::int64_t known_ns);

  /// The end of the file. The last call.
  void finish();

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace seqloop::bags
