// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

namespace seqloop::dds {

/// Which part of ROS 2's network to join.
struct Network {
  std::uint32_t domain = 0;   ///< 0 .. 232
  std::string configuration;  ///< of Cyclone DDS, XML; what comes later in it counts
};

/// A variable of the environment. @return null where it is not set
using Environment = std::function<const char*(const char*)>;

/// What ROS 2's variables ask for: ROS_DOMAIN_ID; ROS_AUTOMATIC_DISCOVERY_RANGE;
/// ROS_LOCALHOST_ONLY, which wins over it. This machine only is as Iron and later have it where the
/// range is set or ROS_DISTRO is another than humble, otherwise as Humble has it; the two do not
/// find each other. CYCLONEDDS_URI overrides the rest. Messages of more than 128 MiB are not taken
/// unless that raises Internal/MaxSampleSize.
/// @param priority SCHED_FIFO priority of the threads that receive; 0: ordinary scheduling
/// Throws SetupError: a domain or a range that is none; discovery that is switched off.
[[nodiscard]] Network network(const Environment& environment, int priority = 0);

/// Refuses a name that ROS 2 would not take for a topic. @param flag that gave it
/// Throws SetupError.
void check_topic(std::string_view topic, const std::string& flag);

}  // namespace seqloop::dds
