// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace seqloop::bags {

/// Where a robot believes to be, in a frame that does not move.
struct OdometryPose {
  std::int64_t stamp_ns = 0;                              ///< since 1970, of the header
  std::array<double, 3> position{};                       ///< x, y, z in metres
  std::array<double, 4> orientation{0.0, 0.0, 0.0, 1.0};  ///< x, y, z, w; as the message has it
};

/// Reads all messages `nav_msgs/msg/Odometry` of a topic, in the order of the bag; those that
/// cannot be read are left out. Throws SetupError: as `open_bag`; no such topic, or of another
/// type.
[[nodiscard]] std::vector<OdometryPose> read_odometry(const std::filesystem::path& bag,
                                                      const std::string& topic);

}  // namespace seqloop::bags
