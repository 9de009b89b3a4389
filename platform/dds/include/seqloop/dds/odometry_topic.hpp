// SPDX-License-Identifier: MIT
#pragma once

#include <atomic>
#include <cstdint>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "seqloop/dds/participant.hpp"
#include "seqloop/ros/odometry.hpp"

namespace seqloop::dds {

/// Listens to a topic `nav_msgs/msg/Odometry`, in a thread of its own, and keeps what it says, in
/// bounded memory: at most a million poses (64 MB), of which ever fewer a second are kept as the
/// drive grows. Stamps may go back. A publisher may come late, go and come back.
class OdometryTopic {
 public:
  static constexpr std::size_t most_poses = 1'000'000;

  /// @param participant lives longer. Throws SetupError: no such topic can be, or no thread.
  OdometryTopic(const Participant& participant, std::string topic, std::size_t most = most_poses);
  OdometryTopic(const OdometryTopic&) = delete;
  OdometryTopic& operator=(const OdometryTopic&) = delete;
  OdometryTopic(OdometryTopic&&) = delete;
  OdometryTopic& operator=(OdometryTopic&&) = delete;
  ~OdometryTopic();

  /// All that is kept, in the order in which it came. Any thread may ask.
  [[nodiscard]] std::vector<ros::OdometryPose> poses() const;

 private:
  void listen() noexcept;
  void keep(const ros::OdometryPose& pose);

  const Participant& participant_;
  std::string topic_;
  std::size_t most_;
  mutable std::mutex mutex_;
  std::vector<ros::OdometryPose> poses_;
  std::int64_t least_interval_ns_ = 5'000'000;
  std::atomic<bool> ending_{false};
  std::thread thread_;
};

}  // namespace seqloop::dds
