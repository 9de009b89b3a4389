// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "seqloop/clock.hpp"
#include "seqloop/dds/participant.hpp"
#include "seqloop/ros/loop_closure.hpp"
#include "seqloop/ros/status.hpp"

namespace seqloop::dds {

/// What a run says to ROS 2:
///
/// | topic | type |
/// |---|---|
/// | /seqloop/loop_closures | seqloop_msgs/msg/LoopClosure |
/// | /seqloop/status | seqloop_msgs/msg/Status |
/// | /diagnostics | diagnostic_msgs/msg/DiagnosticArray |
/// | /seqloop/matched_pair/compressed | sensor_msgs/msg/CompressedImage |
///
/// All are RELIABLE, VOLATILE, KEEP_LAST. Not for the thread of the loop: what is sent is copied,
/// and goes into the network before the call returns. Where subscribers are too slow, a call does
/// not wait for them.
class Publisher {
 public:
  /// @param participant lives longer. Throws SetupError.
  explicit Publisher(const Participant& participant);
  Publisher(const Publisher&) = delete;
  Publisher& operator=(const Publisher&) = delete;
  Publisher(Publisher&&) = delete;
  Publisher& operator=(Publisher&&) = delete;
  ~Publisher();

  /// @return false where it was dropped. Allocates: yes.
  [[nodiscard]] bool publish(const ros::LoopClosure& closure);
  [[nodiscard]] bool publish(const ros::Status& status);
  [[nodiscard]] bool publish(std::int64_t stamp_ns, std::span<const ros::Diagnosis> diagnoses);
  [[nodiscard]] bool publish_pair(std::int64_t stamp_ns, std::span<const std::uint8_t> jpeg);

  /// Whether anybody subscribes to the pairs.
  [[nodiscard]] bool pair_is_wanted() const noexcept;

  /// Returns when all subscribers that are there have what was sent, or after the time.
  void flush(Nanoseconds at_most) noexcept;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace seqloop::dds
