// SPDX-License-Identifier: MIT
#include "program/drives/live_topic.hpp"
#include "seqloop/fault.hpp"

namespace seqloop::program {

std::shared_ptr<dds::Participant> join_ros(const RealTimeSettings& /*real_time*/) {
  throw SetupError({"ROS 2", "this program was built without it",
                    "build it where Debian's cyclonedds-dev and cyclonedds-tools are installed"});
}

LiveTopic open_topic(const std::filesystem::path& /*path*/,
                     const std::shared_ptr<dds::Participant>& /*participant*/, double /*fps*/,
                     Describer& /*describer*/, const RealTimeSettings& /*real_time*/,
                     Clock& /*clock*/) {
  return {};
}

std::function<std::vector<ros::OdometryPose>()> open_odometry(
    const std::string& /*topic*/, const std::shared_ptr<dds::Participant>& /*participant*/) {
  return {};
}

}  // namespace seqloop::program
