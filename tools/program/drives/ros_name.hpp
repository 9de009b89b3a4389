// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <string>

namespace seqloop::program {

/// Whether a path means a topic of ROS 2: `ros:/camera/image_raw`.
[[nodiscard]] inline bool is_topic(const std::filesystem::path& path) {
  return path.native().starts_with("ros:");
}

/// The topic's own name: `/camera/image_raw`.
[[nodiscard]] inline std::string topic_of(const std::filesystem::path& path) {
  return path.native().substr(4);
}

}  // namespace seqloop::program
