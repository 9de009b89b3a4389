// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "program/drives/ros_name.hpp"
#include "program/options/real_time_options.hpp"
#include "seqloop/describer.hpp"
#include "seqloop/linux/live_source.hpp"
#include "seqloop/ros/odometry.hpp"

namespace seqloop::dds {
class Participant;
}

namespace seqloop::program {

/// Joins ROS 2's network, as the environment says. Nothing is opened before. What receives messages
/// is scheduled as a capture thread is. Throws SetupError; also where this build has no DDS.
[[nodiscard]] std::shared_ptr<dds::Participant> join_ros(const RealTimeSettings& real_time);

/// A topic that is listened to.
struct LiveTopic {
  std::unique_ptr<live::LiveSource> source;
  /// When second 0 was, in nanoseconds since 1970 by the headers; once a frame has come. May be
  /// called as long as the source is there.
  std::function<std::int64_t()> start_ns;
  /// What the headers said at a time in seconds; likewise, and 0 where that is not known any more.
  /// Any thread may ask.
  std::function<std::int64_t(double time_s)> stamp_ns;
};

/// Begins to listen to pictures; whether anybody publishes any does not matter. They are decoded as
/// those of recordings are. Throws SetupError.
/// @param fps frames a second, at least; at 3 intervals without one, but not before a second, the
///   topic counts as silent
[[nodiscard]] LiveTopic open_topic(const std::filesystem::path& path,
                                   const std::shared_ptr<dds::Participant>& participant, double fps,
                                   Describer& describer, const RealTimeSettings& real_time,
                                   Clock& clock);

/// Begins to listen to odometry. @return what gives all that has come; it keeps listening as long
/// as it is there. Throws SetupError.
[[nodiscard]] std::function<std::vector<ros::OdometryPose>()> open_odometry(
    const std::string& topic, const std::shared_ptr<dds::Participant>& participant);

}  // namespace seqloop::program
