// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace seqloop::ros {

/// What `msg/Status.msg` says of a run.
struct Status {
  std::int64_t stamp_ns = 0;  ///< when the newest frame was taken, since 1970
  std::string state;
  std::uint64_t frames = 0;
  std::uint64_t matches = 0;
  std::uint64_t places = 0;
  std::optional<std::uint64_t> place;  ///< none: not known
  double probability = 0.0;
  std::uint64_t errors = 0;
  std::uint64_t dropped = 0;
  std::uint64_t lost = 0;
  std::uint64_t misses = 0;
  std::uint64_t unpublished = 0;
};

/// `diagnostic_msgs/msg/DiagnosticStatus`, which every tool of ROS shows.
struct Diagnosis {
  enum class Level : std::uint8_t { ok, warning, error };

  Level level = Level::ok;
  std::string name;
  std::string message;
  std::vector<std::pair<std::string, std::string>> values;
};

}  // namespace seqloop::ros
