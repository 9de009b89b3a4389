// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

namespace seqloop::ros {

/// Where a robot believes to be, in a frame that does not move.
struct OdometryPose {
  std::int64_t stamp_ns = 0;                              ///< since 1970, of the header
  std::array<double, 3> position{};                       ///< x, y, z in metres
  std::array<double, 4> orientation{0.0, 0.0, 0.0, 1.0};  ///< x, y, z, w; as the message has it
};

/// Reads a message `nav_msgs/msg/Odometry`. @return nothing where it cannot be read
/// Allocates: never.
[[nodiscard]] std::optional<OdometryPose> read_odometry(
    std::span<const std::uint8_t> message) noexcept;

}  // namespace seqloop::ros
