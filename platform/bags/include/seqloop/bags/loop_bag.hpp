// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string_view>

namespace seqloop::bags {

/// What `msg/LoopClosure.msg` says of an accepted answer.
struct LoopClosure {
  std::int64_t stamp_ns = 0;        ///< when the frame was taken, since 1970
  std::int64_t match_stamp_ns = 0;  ///< when the place was seen; 0: not known
  std::uint64_t frame = 0;
  std::uint64_t match = 0;
  std::string_view session;  ///< of the place; empty: the drive's own
  double probability = 0.0;  ///< NaN: decided by uniqueness
  double uniqueness = 0.0;   ///< NaN: none
  double score = 0.0;
  double velocity = 0.0;
};

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
  void add(const LoopClosure& closure, std::int64_t known_ns);

  /// The end of the file. The last call.
  void finish();

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace seqloop::bags
