// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "program/run/pose.hpp"
#include "seqloop/ros/odometry.hpp"

namespace seqloop::program {

/// Where the robot believed to be, over time.
class Odometry {
 public:
  struct Sample {
    double time_s;  ///< since the drive's second 0
    Pose pose;
  };

  /// @param samples with times that rise; at least two
  explicit Odometry(std::vector<Sample> samples) : samples_(std::move(samples)) {}

  /// @return between the two samples around a time; nothing before the first and after the last
  [[nodiscard]] std::optional<Pose> at(double time_s) const noexcept;

  [[nodiscard]] double first_s() const noexcept { return samples_.front().time_s; }
  [[nodiscard]] double last_s() const noexcept { return samples_.back().time_s; }

 private:
  std::vector<Sample> samples_;
};

/// Takes lines `time x y z qx qy qz qw` (TUM); `#` begins a comment.
/// @param start_s what the file's clock said at the drive's second 0
/// Throws SetupError: a line that is none, times that do not rise, fewer than two.
[[nodiscard]] Odometry parse_tum(const std::string& text, const std::string& name, double start_s);

/// What a topic said. @param start_ns when the drive's second 0 was
/// Throws SetupError: fewer than two poses whose times rise, or the times of another clock.
[[nodiscard]] Odometry odometry_of(const std::vector<ros::OdometryPose>& poses,
                                   const std::string& topic, std::int64_t start_ns);

/// Reads a topic of the drive's own bag, or a file. @param what names one or the other
/// @param source the drive   @param start_ns when its second 0 was; 0: a file counts from there
/// Throws SetupError; also where the times are those of another clock.
[[nodiscard]] Odometry read_odometry(const std::string& what, const std::filesystem::path& source,
                                     std::int64_t start_ns);

}  // namespace seqloop::program
