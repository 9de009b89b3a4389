// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "seqloop/ros/odometry.hpp"

namespace seqloop::bags {

/// Reads all messages `nav_msgs/msg/Odometry` of a topic, in the order of the bag; those that
/// cannot be read are left out. Throws SetupError: as `open_bag`; no such topic, or of another
/// type.
[[nodiscard]] std::vector<ros::OdometryPose> read_odometry(const std::filesystem::path& bag,
                                                           const std::string& topic);

}  // namespace seqloop::bags
